"""All figures of the hidden-effect suite."""

from __future__ import annotations

from .confusion import confusion_figure
from .parameters import parameters_figure
from .rates import rates_figure
from .strength import strength_figure


def suite_figures(rows, rates, confusion):
    """Return the Sheets of the suite, in the order of the page.

    rows: judged rows. rates, confusion: rows of rates.csv and confusion.csv.
    """
    return [
        *rates_figure(rates),
        *confusion_figure(confusion),
        *strength_figure(rows),
        *parameters_figure(rows),
    ]
