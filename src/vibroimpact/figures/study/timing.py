"""Where the time of a study went: CPU time by rule and part."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLUE, GREEN, GREY, ORANGE, PALE, PINK, SKY, label_of
from vibroimpact.study.timing import METHOD

COLOURS = {
    "kernel": BLUE,
    "output filter": SKY,
    "spectra": GREEN,
    "identification": ORANGE,
    "force": PINK,
    "rest": PALE,
}
ORDER = tuple(COLOURS)


def timing(config, rows):
    """Return the Sheet of the CPU time of a study.

    rows: table of timing.timing_rows, list of {column: value}.
    """
    whole = next(row for row in rows if row["rule"] == "all" and row["part"] == "")
    share = sum(row["share"] for row in rows if row["rule"] == "all" and row["part"] in METHOD)
    caption = (
        f"CPU time of the {whole['jobs']} jobs of the study '{config.study}' by rule, summed over"
        f" jobs: {whole['cpu_s']:.0f} s in all, {100 * share:.0f} % of it in"
        f" {', '.join(METHOD[:-1])} and {METHOD[-1]}. Rest: starting Python and its imports, files,"
        " drawing. At the end of each bar the number of jobs and the largest memory of one. From"
        " the logs and benchmark files of the last run of each job."
    )
    rules = [row for row in rows if row["part"] == "" and row["rule"] != "all"]
    sheet = Sheet("timing", "Where the time goes", caption, size=(7.6, 1.4 + 0.34 * len(rules)))
    axes = sheet.axes["main"]
    for place, rule in enumerate(rules):
        start = 0.0
        parts = [row for row in rows if row["rule"] == rule["rule"] and row["part"]]
        for row in sorted(
            parts, key=lambda row: ORDER.index(row["part"]) if row["part"] in ORDER else len(ORDER)
        ):
            sheet.record(
                axes,
                row["part"],
                rule=rule["rule"],
                jobs=rule["jobs"],
                cpu_s=row["cpu_s"],
                max_rss_MB=rule["max_rss_MB"],
            )
            axes.barh(
                place,
                row["cpu_s"],
                left=start,
                color=COLOURS.get(row["part"], GREY),
                edgecolor="none",
                height=0.7,
            )
            start += row["cpu_s"]
        axes.annotate(
            f"{rule['jobs']} × {rule['cpu_s'] / rule['jobs']:.1f} s, {rule['max_rss_MB']:.0f} MB",
            (start, place),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    shown = [name for name in COLOURS if any(row["part"] == name for row in rows)]
    for name in shown:
        axes.barh(0, 0, color=COLOURS[name], label=name)
    axes.set_yticks(np.arange(len(rules)), [row["rule"] for row in rules])
    axes.invert_yaxis()
    axes.margins(x=0.2)
    axes.grid(axis="y", visible=False)
    axes.set_xlabel(label_of("cpu_s"))
    axes.set_ylabel("Rule")
    sheet.legend(axes, loc="lower right")
    return [sheet]
