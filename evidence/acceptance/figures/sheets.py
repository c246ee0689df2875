"""All figures of the acceptance of verdicts."""

from __future__ import annotations

from .confusion import confusion_figure
from .parameters import parameters_figure
from .rates import rates_figure
from .reliability import reliability_figure
from .strength import strength_figure


def acceptance_figures(rows, tables):
    """Return the Sheets, in the order of the page.

    rows: judged rows. tables: rows of table.csv, reliability.csv and confusion.csv by name.
    """
    return [
        *rates_figure(tables["table"]),
        *reliability_figure(tables["reliability"]),
        *confusion_figure(tables["confusion"]),
        *strength_figure(rows),
        *parameters_figure(rows),
    ]
