"""Parameters of named effects against their true values."""

from __future__ import annotations

import numpy as np

from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import BLACK, BLUE, RED, label_of

WIDE = 4.0  # ratio of the ends from which on the axis is logarithmic


def parameters_figure(rows):
    """Return [Sheet] of estimate over truth with its interval, one line per campaign.

    rows: judged rows that name a parameter.
    """
    rows = sorted(
        (row for row in rows if row["parameter"]),
        key=lambda row: (row["parameter"], row["campaign"]),
    )
    caption = (
        "Parameters of named effects over their true values, with the verdicts' 90 % intervals,"
        " where both codes state the same quantity. Filled: the interval covers the truth; open: it"
        " does not."
    )
    sheet = Sheet(
        "acceptance_parameters",
        "Parameters against the truth",
        caption,
        size=(8.0, 1.7 + 0.26 * max(len(rows), 3)),
    )
    axes = sheet.axes["main"]
    axes.set_xlabel(label_of("estimate_over_truth"))
    axes.set_yticks([])
    if not rows:
        axes.text(
            0.5,
            0.5,
            "no verdict named a parameter that the truth states too",
            transform=axes.transAxes,
            ha="center",
            va="center",
        )
        axes.set_xticks([])
        return [sheet]
    ratio, one, other = (
        np.array([row[key] / row["true"] for row in rows]) for key in ("value", "low", "high")
    )
    low, high = (
        np.minimum(one, other),
        np.maximum(one, other),
    )  # a negative truth turns the interval round
    covered = np.array([row["covered"] for row in rows], bool)
    places = np.arange(len(rows))
    for words, chosen, style in (
        ("interval covers the truth", covered, {"color": BLUE}),
        ("it does not", ~covered, {"color": RED, "markerfacecolor": "white"}),
    ):
        if chosen.any():
            names, numbers = (
                np.array([row[key] for row in rows])[chosen] for key in ("parameter", "campaign")
            )
            gid = sheet.record(
                axes,
                words,
                campaign=numbers,
                parameter=names,
                estimate_over_truth=ratio[chosen],
                estimate_over_truth_low=low[chosen],
                estimate_over_truth_high=high[chosen],
            )
            spread = np.maximum([ratio[chosen] - low[chosen], high[chosen] - ratio[chosen]], 0.0)
            axes.errorbar(
                ratio[chosen],
                places[chosen],
                xerr=spread,
                fmt="o",
                capsize=2,
                label=words,
                gid=gid,
                **style,
            )
    axes.axvline(1.0, color=BLACK, linewidth=0.8)
    if low.min() > 0.0 and high.max() > WIDE * low.min():
        axes.set_xscale("log")
    axes.set_yticks(
        places,
        [
            f"{row['parameter'].replace('.', ': ').replace('_', ' ')},"
            f" {row['campaign'].removeprefix('campaign_')}"
            for row in rows
        ],
    )
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.grid(False, axis="y")
    axes.set_title(
        f"{covered.sum()} of {covered.size} intervals cover the truth ({100 * covered.mean():.0f}"
        f" %); median error {100 * np.median(np.abs(ratio - 1.0)):.2g} %"
    )
    sheet.figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return [sheet]
