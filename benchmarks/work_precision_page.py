"""The part of docs/performance.md on work and precision of the two schemes."""

from benchmarks.table import three_digits
from benchmarks.work_precision_figure import UNSEEN

TEXT = f"""## What a step is worth

Written from `results/benchmark/work_precision.csv` (`python -m benchmarks.work_precision`, part \
of `make benchmark`). Both schemes cost the same
per step. R3 is a mass driven against a stiff stop, its published contact times; R11 an \
oscillator between two stops under white noise,
its exact stationary statistics, 64 records; the tube's statistics are compared seed by seed \
with Newmark at 1/204800 s on the same forces, 16 records
of 16 s per load, RMS over the statistics that one record resolves. One run in R3, batches of \
eight in the others.

Where contact decides (R3) the schemes are equal: both find the touch inside a step to second \
order. In R11 the exact step is nearer to the law by
1.15 to 1.5 times at the same step. The tube's motion is chaotic, and no step of either scheme \
can be told from the finest one: all differences are
below {UNSEEN:g} standard errors of the seeds. What is left to choose by is the linear motion \
between impacts: Newmark lowers the frequency of a mode
by (omega dt)²/12, 0.8 % at 1 kHz with 20480 steps per second and 0.13 % with 51200, and at \
20480 is refused beside modes to 7.5 kHz (omega dt = 2.3);
the exact step has no error there at any step. So the default is the exact step at 20480, at \
half the cost of the paper's; Newmark at 51200 stays a key away
(`integration: {{scheme: newmark, steps_per_second: 51200}}`). What 20480 does cost is energy \
lost at each crossing of the gap (1.3 % of the input
work instead of 0.2 %) and the very tips of force and stress peaks, which a longer step samples \
less often.
"""


def section(rows, figure):
    """Return the Markdown of rows (work_precision.COLUMNS, numbers or their text) and the figure's
    path.
    """
    lines = [
        "problem",
        "steps per second",
        "Newmark: error",
        "CPU ms per simulated s",
        "exact step: error",
        "CPU ms per simulated s",
        "standard error",
    ]
    table = [lines, ["---"] * len(lines)]
    for case, rate in dict.fromkeys((row["case"], float(row["steps_per_second"])) for row in rows):
        found = {
            row["scheme"]: row
            for row in rows
            if (row["case"], float(row["steps_per_second"])) == (case, rate)
        }
        cells = [
            text
            for scheme in ("newmark", "exact")
            for text in (
                f"{float(found[scheme]['error']):.2g}",
                three_digits(1e3 * float(found[scheme]["cpu_s_per_simulated_s"])),
            )
        ]
        spread = float(found["exact"]["standard_error"])
        table.append([case, f"{rate:.0f}", *cells, f"{spread:.1g}" if spread else ""])
    return "\n".join(
        [
            TEXT,
            f"![Error against CPU time]({figure})\n",
            *("| " + " | ".join(line) + " |" for line in table),
            "",
        ]
    )
