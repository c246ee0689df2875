"""What is true of what is said with a probability."""

from __future__ import annotations

import numpy as np

from evidence.acceptance.calibration import FEWEST, largest_gap
from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import BLUE, GREY, label_of


def reliability_figure(curve):
    """Return [Sheet] of the reliability curve.

    curve: rows of reliability.csv.
    """
    caption = (
        "Every statement of a verdict that carries a probability: that nothing is missing, that"
        " something outside the catalogue is, and each explanation. Points: share that is true"
        " against the mean probability stated, in tenths joined until each holds at least"
        f" {FEWEST} statements, with 95 % intervals (Wilson). Grey: as stated."
    )
    sheet = Sheet("acceptance_reliability", "Are probabilities right?", caption, size=(6.0, 5.4))
    axes = sheet.axes["main"]
    if not curve:
        sheet.note(axes, "no verdict states a probability", "stated_probability", "true_share")
        axes.set(xticks=[], yticks=[])
        return [sheet]
    stated, true, low, high = (
        np.array([row[key] for row in curve]) for key in ("stated", "true", "low", "high")
    )
    sheet.line(
        axes,
        ("stated_probability", stated),
        ("true_share", true),
        "statements",
        low,
        high,
        {"statements": [row["statements"] for row in curve]},
        band=False,
        fmt="o",
        color=BLUE,
    )
    axes.plot([0.0, 1.0], [0.0, 1.0], color=GREY, linewidth=0.8)
    axes.set(xlim=(-0.03, 1.03), ylim=(-0.03, 1.03), xlabel=label_of("stated_probability"))
    axes.set_title(f"largest gap {largest_gap(curve):.2f}")
    return [sheet]
