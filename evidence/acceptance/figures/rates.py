"""The rows of the acceptance table against their targets."""

from __future__ import annotations

import numpy as np
from matplotlib.lines import Line2D

from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import BLACK, BLUE, GREY, ORANGE, label_of, shown

STANDINGS = {"met": ("target met", BLUE, "o"), "missed": ("target missed", ORANGE, "D")}
TARGET = {"marker": "|", "color": BLACK, "markersize": 15, "markeredgewidth": 2.0}


def rates_figure(table):
    """Return [Sheet] of the shares in the rows of table.csv: a point with its interval for each.

    A bar marks the target.
    """
    caption = (
        "Each row is a question to the verdicts of one kind of campaigns, n how many of them."
        " Point: share, with its 95 % interval (Wilson). Black bars: target."
    )
    rows = [row for row in table if row["count"] is not None and row["campaigns"]]
    sheet = Sheet(
        "acceptance_rates",
        "Verdicts against their targets",
        caption,
        size=(9.0, 1.9 + 0.34 * max(len(rows), 3)),
    )
    axes = sheet.axes["main"]
    axes.set_xlabel(label_of("rate"))
    axes.set_yticks([])
    if not rows:
        axes.text(
            0.5, 0.5, "no campaign was judged", transform=axes.transAxes, ha="center", va="center"
        )
        axes.set_xticks([])
        return [sheet]
    for place, row in enumerate(rows):
        _row(sheet, axes, place, row)
    axes.set_yticks(
        range(len(rows)),
        [f"{row['kind']}: {row['quantity']} (n = {row['campaigns']})" for row in rows],
    )
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(-2.0, 102.0)
    axes.grid(False, axis="y")
    handles = [
        Line2D([], [], linestyle="-", marker=marker, color=colour, label=words)
        for words, colour, marker in STANDINGS.values()
    ]
    handles.append(Line2D([], [], linestyle="", label="target", **{**TARGET, "markersize": 8}))
    sheet.figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return [sheet]


def _row(sheet, axes, place, row):
    """Draw one row: its target, and the share with its interval on top."""
    values = {key: float(row[key]) for key in ("rate", "low", "high", "least", "most")}
    gid = sheet.record(
        axes,
        f"{row['kind']}: {row['quantity']}",
        campaigns=row["campaigns"],
        **values,
        standing=row["standing"],
    )
    for key in ("least", "most"):
        if np.isfinite(values[key]):
            axes.plot(shown("rate", values[key]), place, linestyle="", **TARGET)
    _, colour, marker = STANDINGS[row["standing"]]
    axes.hlines(
        place, *shown("rate", [values["low"], values["high"]]), color=GREY, linewidth=1.6, zorder=3
    )
    axes.plot(
        shown("rate", values["rate"]), place, marker, color=colour, markersize=7, gid=gid, zorder=4
    )
