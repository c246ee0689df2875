"""The figure of the benchmark: how many times faster than each peer, per run, with the smallest and
largest of the pairs.
"""

import matplotlib.pyplot as plt
import numpy as np

from evidence.benchmarks.table import SECONDS, three_digits
from vibroimpact.reports.figures.style import BLUE, GREEN, GREY, ORANGE, SKY, tidy_log_axes

COLOURS = (ORANGE, BLUE, GREEN, SKY)
BAR = 0.8  # height of the bars of one peer together


def draw(rows, path):
    """Draw rows (table.COLUMNS) to a PNG: a panel per case, a group of bars per peer, a colour per
    way that ours ran.
    """
    rows = [row for row in rows if row["unit"] == SECONDS]
    cases = list(dict.fromkeys(row["case"] for row in rows))
    quantities = list(dict.fromkeys(row["quantity"] for row in rows))
    peers = {
        case: list(dict.fromkeys(row["peer"] for row in rows if row["case"] == case))
        for case in cases
    }
    height = [len(peers[case]) + 1.0 for case in cases]
    figure, axes = plt.subplots(
        len(cases),
        1,
        figsize=(8.0, 1.2 + 0.52 * sum(height)),
        layout="constrained",
        sharex=True,
        squeeze=False,
        gridspec_kw={"height_ratios": height},
    )
    for case, axis in zip(cases, axes[:, 0], strict=True):
        for number, quantity in enumerate(quantities):
            chosen = [row for row in rows if (row["case"], row["quantity"]) == (case, quantity)]
            place = [
                peers[case].index(row["peer"]) + BAR * ((number + 0.5) / len(quantities) - 0.5)
                for row in chosen
            ]
            ratio, low, high = (
                np.array([row[f"ratio_{name}"] for row in chosen])
                for name in ("median", "min", "max")
            )
            # From 1 on: a bar to the left of it is a peer that is faster.
            axis.barh(
                place,
                ratio - 1.0,
                BAR / len(quantities),
                1.0,
                color=COLOURS[number % len(COLOURS)],
                label=f"ours: {quantity}",
            )
            axis.errorbar(
                ratio,
                place,
                xerr=[ratio - low, high - ratio],
                fmt="none",
                ecolor="black",
                capsize=2.0,
                linewidth=0.9,
            )
            for row, at in zip(chosen, place, strict=True):
                behind = (max(row["ratio_max"], 1.0), at)
                axis.annotate(
                    three_digits(row["ratio_median"]),
                    behind,
                    (4.0, 0.0),
                    textcoords="offset points",
                    va="center",
                    fontsize=7.5,
                )
        axis.set_xscale("log")
        axis.axvline(1.0, color=GREY, linewidth=1.0)
        axis.set_yticks(range(len(peers[case])), peers[case])
        axis.invert_yaxis()
        axis.set_title(case)
    axes[0, 0].set_xlim(
        min(0.7, 0.8 * min(row["ratio_min"] for row in rows)),
        4.0 * max(row["ratio_max"] for row in rows),
    )  # room for the numbers
    axes[-1, 0].set_xlabel(
        "CPU time of the peer / CPU time of ours, per simulated second and run (-)\n"
        "Bars: median of the pairs; whiskers: smallest and largest"
    )
    tidy_log_axes(figure)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    figure.savefig(path, dpi=130)
    plt.close(figure)
