"""The probabilities of the explanations."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import WIDTH_IN, Sheet
from vibroimpact.figures.style import BLUE, GREY, ORANGE, label_of
from vibroimpact.reports.explanations import (
    Explanation,
    chance_text,
    explanations_of,
    not_explained,
)
from vibroimpact.verdict.content import Verdict, not_run_sentence

from .states import bars, empty_sheet, name_rows

MOST_BARS = 14
NONE_KNOWN = "no probabilities are known that the verdict stands by"

CAPTION = (
    "Probability of each explanation among all that are shown, given the records and what was held"
    " probable before; the places of one effect together. Orange: what is named, or all that is not"
    " told apart. Grey: nothing is missing, and something {rest}.{left_out}"
)


def ranking_figure(verdict: Verdict) -> Sheet:
    """Return the Sheet of bars of the probabilities, the most probable first."""
    rows = explanations_of(verdict)
    if not rows:
        return empty_sheet("diagnosis_ranking", "Probabilities", NONE_KNOWN)
    shown = rows[:MOST_BARS]
    left = sum(row.probability for row in rows[MOST_BARS:])
    words = f" {len(rows) - MOST_BARS} more have {100.0 * left:.2g} % together." if left else ""
    words += not_run_sentence(verdict.not_run)
    first = rows[0]
    sheet = Sheet(
        "diagnosis_ranking",
        f"Most probable: {first.words}, {chance_text(first.probability)}",
        CAPTION.format(rest=not_explained(verdict), left_out=words),
        size=(WIDTH_IN, 1.2 + 0.3 * max(len(shown), 3)),
    )
    _bars(sheet, sheet.axes["main"], shown)
    return sheet


def _bars(sheet, axes, rows: list[Explanation]):
    """Draw a bar per explanation with its probability beside it."""
    values, places = np.array([row.probability for row in rows]), np.arange(len(rows))
    colours = [ORANGE if row.told else GREY if row.open else BLUE for row in rows]
    gid = sheet.record(
        axes, "probability", explanation=[row.words for row in rows], probability=values
    )
    bars(axes, places, 100.0 * values, [*map(chance_text, values)], gid, color=colours)
    name_rows(axes, [row.words for row in rows])
    axes.set_xlim(0.0, 112.0)
    axes.set_xticks(range(0, 101, 20))
    axes.set_xlabel(label_of("probability"))
