"""The part of docs/performance.md on work and precision of the two schemes."""

from evidence.benchmarks.work_precision_figure import UNSEEN

TEXT = f"""## Choice of the step

From `results/benchmark/work_precision.csv` (`python -m evidence.benchmarks.work_precision`, part of
`make benchmark`). Both schemes cost the same per step.

- R3, a mass driven against a stiff stop, against published contact times: both schemes find the
  touch inside a step to second order.
- R11, an oscillator between two stops under white noise, against exact stationary statistics, 64
  runs: the exact step is 1.15 to 1.5 times nearer to the law.
- The tube, against Newmark at 1/204800 s under the same forces, 16 records of 16 s per load:
  chaotic motion, no difference above {UNSEEN:g} standard errors of the seeds.

The default is the exact step at 20480, half the cost of the paper's step
([reasons](method/integration.md#which-scheme)).
"""


def section(rows, figure):
    """Return the Markdown of rows (work_precision.COLUMNS, numbers or their text) and the figure's
    path.
    """
    header = (
        "problem",
        "steps per second",
        "Newmark: error",
        "exact step: error",
        "standard error",
    )
    table = [header, ["---"] * len(header)]
    for case in dict.fromkeys(row["case"] for row in rows):
        found = [row for row in rows if row["case"] == case]
        by_scheme = {
            scheme: [row for row in found if row["scheme"] == scheme]
            for scheme in ("newmark", "exact")
        }
        spread = max(float(row["standard_error"]) for row in by_scheme["exact"])
        table.append(
            (
                case,
                _list(by_scheme["exact"], "steps_per_second", ".0f"),
                _list(by_scheme["newmark"], "error", ".2g"),
                _list(by_scheme["exact"], "error", ".2g"),
                f"{spread:.1g}" if spread else "",
            )
        )
    return "\n".join(
        [
            TEXT,
            f"![Error against CPU time]({figure})\n",
            *("| " + " | ".join(line) + " |" for line in table),
            "",
        ]
    )


def _list(rows, column, form):
    """Return the column's numbers in a cell."""
    return ", ".join(f"{float(row[column]):{form}}" for row in rows)
