"""The part of docs/performance.md on work and precision of the two schemes."""

from evidence.benchmarks.table import three_digits
from evidence.benchmarks.work_precision_figure import UNSEEN

TEXT = f"""## What a step is worth

From `results/benchmark/work_precision.csv` (`python -m evidence.benchmarks.work_precision`, part of
`make benchmark`). Both schemes cost the same per step.

| problem | compared with | runs |
| --- | --- | --- |
| R3, a mass driven against a stiff stop | published contact times | one |
| R11, an oscillator between two stops under white noise | exact stationary statistics | 64, \
batches of eight |
| the tube | Newmark at 1/204800 s on the same forces, seed by seed; RMS over the statistics that \
one record resolves | 16 records of 16 s per load, batches of eight |

- **R3:** both schemes find the touch inside a step to second order.
- **R11:** the exact step is 1.15 to 1.5 times nearer to the law at the same step.
- **Tube:** the motion is chaotic. All differences are below {UNSEEN:g} standard errors of the \
seeds.
- **Linear motion decides.** Newmark lowers a mode's frequency by (omega dt)²/12: at 1 kHz 0.8 % \
with
  20480 steps per second, 0.13 % with 51200. At 20480 it is refused with modes to 7.5 kHz
  (omega dt = 2.3). The exact step has no such error.

The default is therefore the exact step at 20480, half the cost of the paper's step
(`integration: {{scheme: newmark, steps_per_second: 51200}}`). It loses more energy at each \
crossing of
the gap (1.3 % of the input work, not 0.2 %) and the very tips of force and stress peaks.
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
