"""The work-precision diagram: error against cost, one panel per problem."""

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from vibroimpact.reports.figures.style import BLUE, GREY, RED

# scheme -> (colour, marker, label, where the number of steps stands beside a point, in points)
STYLES = {
    "newmark": (BLUE, "o", "Newmark, average acceleration", (5, 4), "left"),
    "exact": (RED, "s", "exact modal step, force linear in the step", (-5, -10), "right"),
}
TITLES = {
    "R3": "R3, contact times: error / length of a contact",
    "R11": "R11, statistics: against the exact law",
}
UNSEEN = 2.0  # standard errors of the seeds below which no difference is told


def draw(rows, path):
    """Draw rows (work_precision.COLUMNS) to a PNG."""
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure, axes = plt.subplots(2, 2, figsize=(8.6, 7.0), layout="constrained")
    for axis, case in zip(axes.flat, cases, strict=True):
        _panel(axis, [row for row in rows if row["case"] == case])
        axis.set_title(TITLES.get(case, f"{case}: statistics, against Newmark, 1/204800 s"))
    figure.suptitle("Work and precision; beside the points: thousands of steps per second")
    figure.legend(*axes[1, 1].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def _panel(axis, rows):
    """Draw the rows of one problem."""
    for scheme, (colour, marker, label, beside, side) in STYLES.items():
        own = [row for row in rows if row["scheme"] == scheme]
        cost = [1e3 * row["cpu_s_per_simulated_s"] for row in own]
        axis.plot(cost, [row["error"] for row in own], color=colour, marker=marker, label=label)
        for row, at in zip(own, cost, strict=True):
            axis.annotate(
                f"{row['steps_per_second'] / 1000:g}",
                (at, row["error"]),
                beside,
                textcoords="offset points",
                ha=side,
                fontsize=7,
                color=colour,
            )
    floor = UNSEEN * max(row["standard_error"] for row in rows)
    low = 0.3 * min(row["error"] for row in rows)
    if floor > 0.0:
        axis.axhspan(
            low,
            floor,
            color=GREY,
            alpha=0.2,
            linewidth=0,
            label="below two standard errors of the seeds: nothing told",
        )
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_ylim(low, 3.0 * max(floor, *(row["error"] for row in rows)))
    cost = [1e3 * row["cpu_s_per_simulated_s"] for row in rows]
    axis.set_xlim(0.75 * min(cost), 1.4 * max(cost))
    for each in (axis.xaxis, axis.yaxis):
        each.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        each.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        each.set_minor_formatter(NullFormatter())
    axis.set_xlabel("CPU time per simulated second (ms)")
    axis.set_ylabel("Relative error (-)")
