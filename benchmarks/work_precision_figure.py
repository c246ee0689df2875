"""The work-precision diagram: error against cost, one panel per problem."""

import matplotlib.pyplot as plt

from vibroimpact.figures.style import BLUE, GREY, RED

STYLES = {"newmark": (BLUE, "o", "Newmark, average acceleration"), "exact": (RED, "s", "exact modal step, force linear in the step")}
TITLES = {"R3": "R3: contact times / contact", "R11": "R11: statistics, exact law"}


def draw(rows, path):
    """Draw rows (work_precision.COLUMNS) to a PNG."""
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure, axes = plt.subplots(2, 2, figsize=(8.0, 6.4), layout="constrained")
    for axis, case in zip(axes.flat, cases, strict=True):
        for scheme, (colour, marker, label) in STYLES.items():
            own = [row for row in rows if (row["case"], row["scheme"]) == (case, scheme)]
            cost = [1e3 * row["cpu_s_per_simulated_s"] for row in own]
            axis.plot(cost, [row["error"] for row in own], color=colour, marker=marker, label=label)
            for row, at in zip(own, cost, strict=True):
                axis.annotate(f"{row['steps_per_second']:g}", (at, row["error"]), (4, 4), textcoords="offset points", fontsize=7, color=colour)
        floor = [row["standard_error"] for row in rows if row["case"] == case]
        if max(floor) > 0.0:
            axis.axhspan(axis.get_ylim()[0] * 1e-3, sum(floor) / len(floor), color=GREY, alpha=0.2, linewidth=0, label="standard error of the seeds")
        axis.set_xscale("log")
        axis.set_yscale("log")
        low = min(min(row["error"] for row in rows if row["case"] == case), min(value for value in [*floor, 1.0] if value > 0.0))
        axis.set_ylim(0.5 * low, None)
        axis.set_title(TITLES.get(case, f"{case}: statistics, against 1/204800 s"))
        axis.set_xlabel("CPU time per simulated second (ms)")
        axis.set_ylabel("Relative error (-)")
    figure.suptitle("Work and precision; numbers: steps per second")
    figure.legend(*axes[1, 1].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    figure.savefig(path, dpi=130)
    plt.close(figure)
