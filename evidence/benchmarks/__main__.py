"""The project beside what a user would otherwise pick, measured in one run.

python -m evidence.benchmarks
    everything: results/benchmark/, docs/performance.md and its figure
python -m evidence.benchmarks --quick
    the same in small, to results/benchmark_quick/, the page beside the tables
python -m evidence.benchmarks --page
    page and figure anew from the tables of the last run
python -m evidence.benchmarks --peers plain --no-growth --quick
    our kernel beside the plain numba loop, in seconds

Without --quick it puts this machine's rows into evidence/benchmarks/machines.csv.
"""

import argparse
import os
import time
from pathlib import Path

from llvmlite.binding import get_host_cpu_name

os.environ.setdefault("OMP_NUM_THREADS", "1")
from evidence.benchmarks.machine import allowed_cores

CORES = allowed_cores()
if hasattr(os, "sched_setaffinity") and __name__ == "__main__":
    os.sched_setaffinity(0, {CORES[-1]})  # before XLA and BLAS count the cores: every code gets one

from evidence.benchmarks.cases import CASES, FILES, available, measure_case  # noqa: E402
from evidence.benchmarks.cores import two_cores  # noqa: E402
from evidence.benchmarks.figure import draw  # noqa: E402
from evidence.benchmarks.growth import growth_points  # noqa: E402
from evidence.benchmarks.machine import description  # noqa: E402
from evidence.benchmarks.machines import keep_machine  # noqa: E402
from evidence.benchmarks.page import write_page  # noqa: E402
from evidence.benchmarks.pairs import Clock, cpu_seconds  # noqa: E402
from evidence.benchmarks.peak import PeakRate  # noqa: E402
from evidence.benchmarks.table import (  # noqa: E402
    COLUMNS,
    GROWTH_COLUMNS,
    MACHINE_COLUMNS,
    PEER_COLUMNS,
    benchmark_rows,
    cores_rows,
    growth_rows,
    read_csv,
    typed,
    write_csv,
)
from evidence.benchmarks.work_precision_page import section  # noqa: E402

QUICK = Clock(repeats=2, ours_s=0.1, peer_scale=0.25)
PEAK_REPEATS = 3
ABSENT = "absent peer"


def main():
    """Measure, then write tables, figure and page."""
    options = _options()
    clock = QUICK if options.quick else Clock(repeats=options.repeats)
    out = Path(options.out or ("results/benchmark_quick" if options.quick else "results/benchmark"))
    docs = out if options.quick or options.out else Path("docs")
    (docs / "figures").mkdir(parents=True, exist_ok=True)
    out.mkdir(parents=True, exist_ok=True)
    say = _teller()
    if options.page:
        _present(out, docs, say)
        return
    found, absent = available(options.peers, say)
    pairs, peers = [], []
    for case in CASES:
        if not options.cases or CASES.index(case) + 1 in options.cases:
            measured, described = measure_case(case, found, clock, say)
            pairs += measured
            peers += described
    points = (
        []
        if options.no_growth
        else [*growth_points(clock, options.quick, say), *two_cores(clock, CORES, say)]
    )
    rows = benchmark_rows(pairs) + cores_rows(points, pairs[0].case if pairs else "")
    write_csv(out / "benchmark.csv", COLUMNS, rows)
    peak = _peak()
    if not options.quick:
        keep_machine(rows, get_host_cpu_name(), peak)
    write_csv(out / "growth.csv", GROWTH_COLUMNS, growth_rows(points))
    write_csv(out / "peers.csv", PEER_COLUMNS, peers)
    write_csv(
        out / "machine.csv",
        MACHINE_COLUMNS,
        [
            {"what": what, "value": value}
            for what, value in {**description(CORES, *peak), **_absences(absent)}.items()
        ],
    )
    for row in rows:
        print(
            f"{row['case']:34s} {row['quantity']:26s} {row['unit']:24s} {row['ours_median']:10.4g}"
            f" {row['peer']:32s} {row['peer_median']:10.4g}  ratio {row['ratio_median']:.3g}"
            f" ({row['ratio_min']:.3g} to {row['ratio_max']:.3g})"
        )
    _present(out, docs, say)


def _present(out, docs, say):
    """Write page and figure from the tables in a folder."""
    rows, growth, peers, described, steps = (
        read_csv(out / f"{name}.csv")
        for name in ("benchmark", "growth", "peers", "machine", "work_precision")
    )
    absent = [row["value"] for row in described if row["what"].startswith(ABSENT)]
    machine = {row["what"]: row["value"] for row in described if not row["what"].startswith(ABSENT)}
    draw(typed(rows), docs / "figures" / "performance.png")
    worth = section(steps, "figures/work_precision.png") if steps else ""
    write_page(
        docs / "performance.md",
        rows,
        growth,
        peers,
        absent,
        machine,
        "figures/performance.png",
        worth,
    )
    say(
        f"written: {out}/benchmark.csv, growth.csv, peers.csv, machine.csv, {docs}/performance.md,"
        f" {docs}/figures/performance.png"
    )


def _absences(sentences):
    """Return {what: sentence} of the peers that are absent."""
    return {f"{ABSENT} {number}": sentence for number, sentence in enumerate(sentences, 1)}


def _options():
    parser = argparse.ArgumentParser(
        prog="python -m evidence.benchmarks",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--quick", action="store_true", help="short runs, two repeats, part of the growth curves"
    )
    parser.add_argument(
        "--repeats", type=int, default=5, help="pairs measured per peer (default 5)"
    )
    parser.add_argument(
        "--peers",
        nargs="+",
        choices=FILES,
        default=FILES,
        help="files of benchmarks/peers to measure",
    )
    parser.add_argument(
        "--cases",
        nargs="+",
        type=int,
        choices=range(1, len(CASES) + 1),
        help="problems to measure, by number",
    )
    parser.add_argument(
        "--no-growth", action="store_true", help="leave out the growth curves and the two processes"
    )
    parser.add_argument(
        "--page",
        action="store_true",
        help="measure nothing: page and figure from the tables there are",
    )
    parser.add_argument(
        "--out", help="folder of the tables, page and figure (default results/benchmark and docs)"
    )
    return parser.parse_args()


def _teller():
    """Return a print that says how many seconds have passed."""
    start = time.perf_counter()
    return lambda sentence: print(f"[{time.perf_counter() - start:6.1f} s] {sentence}", flush=True)


def _peak():
    """Return (GFLOP/s, bits of a vector) of the FMA peak of one core."""
    peak = PeakRate()
    rate = max(peak.flops / cpu_seconds(peak.run) for _ in range(PEAK_REPEATS))
    return 1.0e-9 * rate, peak.vector_bits


if __name__ == "__main__":
    main()
