"""The suite's rates against their targets."""

from __future__ import annotations

import numpy as np
from matplotlib.lines import Line2D

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLACK, BLUE, GREY, ORANGE, PINK, RED, label_of, shown

STANDINGS = {
    "met": ("target met", BLUE, "o"),
    "missed": ("target missed", ORANGE, "D"),
    "fails": ("fails", RED, "s"),
}
MARKS = {
    "target": ("target", {"marker": "|", "color": BLACK, "markersize": 15, "markeredgewidth": 2.0}),
    "fails_beyond": (
        "fails beyond",
        {"marker": "|", "color": RED, "markersize": 15, "markeredgewidth": 2.0},
    ),
    "by_chance": (
        "by chance: truths shuffled",
        {"marker": "x", "color": PINK, "markersize": 6, "markeredgewidth": 1.6},
    ),
}


def rates_figure(rates):
    """Return [Sheet] of the rows of rates.csv: a point with its interval for each.

    Marks show target, failure and chance.
    """
    caption = (
        "Each row is a question to the verdicts of one arm of the suite, n its campaigns. Point:"
        " rate, with its 95 % interval (Clopper-Pearson; quartiles of the two medians, the relative"
        " error of parameters and the share of the excess misfit closed on held-out records). Black"
        " bar: target; red bar and shading: beyond, the row fails. Cross: rate that verdicts dealt"
        " at random among the truths would reach."
    )
    sheet = Sheet(
        "suite_rates",
        "Verdicts against their targets",
        caption,
        size=(9.0, 1.9 + 0.34 * max(len(rates), 3)),
    )
    axes = sheet.axes["main"]
    axes.set_xlabel(label_of("rate"))
    axes.set_yticks([])
    if not rates:
        axes.text(
            0.5, 0.5, "no campaign was judged", transform=axes.transAxes, ha="center", va="center"
        )
        axes.set_xticks([])
        return [sheet]
    end = max(1.0, *(row["high"] for row in rates))
    for place, row in enumerate(rates):
        _row(sheet, axes, place, row, end)
    axes.set_yticks(
        range(len(rates)),
        [f"{row['arm']}: {row['quantity']} (n = {row['campaigns']})" for row in rates],
    )
    axes.set_ylim(len(rates) - 0.4, -0.6)
    axes.set_xlim(-2.0, shown("rate", end) + 2.0)
    axes.grid(False, axis="y")
    held = {row["standing"] for row in rates}
    handles = [
        Line2D([], [], linestyle="-", marker=marker, color=colour, label=words)
        for key, (words, colour, marker) in STANDINGS.items()
        if key in held
    ]
    handles += [
        Line2D([], [], linestyle="", label=words, **{**style, "markersize": 8})
        for words, style in MARKS.values()
    ]
    sheet.figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return [sheet]


def _row(sheet, axes, place, row, end):
    """Draw one row: what fails shaded, marks, and the rate with its interval on top."""
    values = {
        key: float(row[key])
        for key in ("rate", "low", "high", "target", "fails_beyond", "by_chance")
    }
    gid = sheet.record(
        axes,
        f"{row['arm']}: {row['quantity']}",
        campaigns=row["campaigns"],
        **values,
        standing=row["standing"],
    )
    if np.isfinite(values["fails_beyond"]):
        bad_end = end + 0.02 if values["fails_beyond"] > values["target"] else -0.02
        axes.fill_betweenx(
            [place - 0.4, place + 0.4],
            shown("rate", values["fails_beyond"]),
            shown("rate", bad_end),
            color=RED,
            alpha=0.1,
            linewidth=0,
        )
    for key, (_, style) in MARKS.items():
        axes.plot(shown("rate", values[key]), place, linestyle="", **style)
    _, colour, marker = STANDINGS[row["standing"]]
    axes.hlines(
        place, *shown("rate", [values["low"], values["high"]]), color=GREY, linewidth=1.6, zorder=3
    )
    axes.plot(
        shown("rate", values["rate"]), place, marker, color=colour, markersize=7, gid=gid, zorder=4
    )
