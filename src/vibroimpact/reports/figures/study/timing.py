"""The time of a study: CPU time by rule and part."""

import numpy as np

from vibroimpact.reports.figures.plot import Axis, Bars, Panel, Plot, Text
from vibroimpact.reports.figures.style import BLUE, GREEN, GREY, ORANGE, PALE, PINK, SKY
from vibroimpact.study.timing import METHOD

COLOURS = {
    "kernel": BLUE,
    "output filter": SKY,
    "spectra": GREEN,
    "identification": ORANGE,
    "force": PINK,
    "rest": PALE,
}


def timing(config, rows):
    """Return the Plot of the CPU time of a study.

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
    items, ends = _bars(rows, rules)
    axes = (
        Axis("cpu_s", low=0.0, high=1.35 * ends.max()),
        Axis("rule", names=[row["rule"] for row in rules]),
    )
    panel = Panel(*axes, items, legend="lower right")
    size = (7.6, 1.4 + 0.34 * len(rules))
    return Plot("timing", "Where the time goes", caption, {"main": panel}, size=size)


def _bars(rows, rules):
    """Return (Bars of the parts and Texts at their ends, (rule,) CPU s where they end)."""
    parts = dict.fromkeys(row["part"] for row in rows if row["part"])
    shown = [*(name for name in COLOURS if name in parts), *sorted(set(parts) - set(COLOURS))]
    start, items = np.zeros(len(rules)), []
    for part in shown:
        times = {row["rule"]: row["cpu_s"] for row in rows if row["part"] == part}
        at = [place for place, rule in enumerate(rules) if rule["rule"] in times]
        tags = {key: [rules[place][key] for place in at] for key in ("rule", "jobs", "max_rss_MB")}
        values = np.array([times[rules[place]["rule"]] for place in at])
        look = {"colour": COLOURS.get(part, GREY), "label": part if part in COLOURS else ""}
        items.append(Bars(part, at, values, tags, start=start[at], thickness=0.7, **look))
        start[at] += values
    for place, rule in enumerate(rules):
        each = f"{rule['jobs']} × {rule['cpu_s'] / rule['jobs']:.1f} s, {rule['max_rss_MB']:.0f} MB"
        items.append(Text(each, start[place], place, shift=(4, 0), align=("left", "center")))
    return items, start
