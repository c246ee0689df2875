"""docs/performance.md: the tables of a benchmark in words and columns, written anew at every
run.
"""

import numpy as np

from evidence.benchmarks.check import CHECK_S, FIRST_IMPACTS_S, NAMES
from evidence.benchmarks.machines import machine_list
from evidence.benchmarks.pairs import BATCH, ONE_RUN, PEAK
from evidence.benchmarks.problem import BAND_HZ, GAP_M, LOAD_N, RATE, SMALL_BASIS
from evidence.benchmarks.table import NANOSECONDS, SECONDS, three_digits, typed

SMALL_TO_HZ = SMALL_BASIS["basis.free_modes_to_Hz"]

INTRODUCTION = f"""# Performance

Written by `make benchmark`, from `results/benchmark/`; do not edit.

The problem is the stand-in tube under a force in {BAND_HZ[0]:g} to {BAND_HZ[1]:g} Hz at 45 \
degrees of the bend, with two
plates of five contact points and a gap of {GAP_M * 1e3:.3f} mm. At {LOAD_N:g} N RMS a plate bears \
a force half of the
time. "Modes" are free modes and residual vectors of the contacts: 99 in the study, 61 with free \
modes to
{SMALL_TO_HZ:g} Hz. Residual vectors reach 130 kHz and set the step of every explicit method, so \
one case has free
modes alone.

- **Agreement first.** A code is timed once its displacement at three sensors agrees with ours:
  without contact ({CHECK_S:g} s), over the first impacts ({FIRST_IMPACTS_S:g} s), and in RMS.
- **Times** are CPU time of one core without compilation. Ours include set-up, output filter,
  statistics, energies and records; the peers keep three displacements.
- **Ratios** are medians of runs that alternate in one process. Slow peers run a short stretch
  with less contact.
- **Batches.** Eight runs share a vector of 512 bits or two of 256; those of one run lie along its
  modes.
- **Step.** Ours, the plain loop, JAX and Exudyn use Newmark at {RATE} steps per second; the study
  uses [another step](#choice-of-the-step).
"""

# The ratios of the page; the CSV file has those to the other batches too.
COMPARED = (ONE_RUN, BATCH.format(8))

OWN_CELL = """CPU s per simulated s; nanoseconds per step of Newmark; share of the peak rate of
fused multiply-adds that the arithmetic of the step takes.
"""
MACHINES_CELL = """By each machine's last benchmark: plain loop over ours, one run; batch of eight;
the batch's share of the peak; ns per step and run, at 20 N.
"""
PEERS_CELL = "CPU time of a peer over ours: of one run; of a batch of eight.\n"

GROWTH = {
    "modes": "free modes beyond the residual vectors",
    "contact points": "of both plates, free modes alone",
    "supports": "of five points, free modes alone",
    "runs side by side": "61 modes",
    "duration, s": "with set-up and run-out of the filter",
    "processes": "wall-clock time, a batch of 8 each",
}

BATCH_OF_8 = "Batch of 8, 20 N, unless the number of runs is varied.\n"


def write_page(path, rows, growth, peers, absent, machine, figure, work_precision=""):
    """Write the page: rows (table.COLUMNS), growth (table.GROWTH_COLUMNS), peers
    (table.PEER_COLUMNS), sentences, {what: value}, figure's path.

    Rows may come from their files, with text for numbers. work_precision: that section
    (work_precision_page.section).
    """
    rows, growth, peers = (typed(each) for each in (rows, growth, peers))
    parts = [
        INTRODUCTION,
        f"![Ratios of CPU time]({figure})\n",
        f"Machine: {'; '.join(f'{what} {value}' for what, value in machine.items())}.\n",
    ]
    parts += ["## Ours\n", OWN_CELL, _own_times(rows)]
    parts += ["## The peers\n", PEERS_CELL, _ratios(rows)]
    parts += ["## Machines\n", MACHINES_CELL, machine_list()]
    parts += ["## Growth\n", BATCH_OF_8, _growth(growth), _cores(rows)] if growth else []
    parts += [work_precision] if work_precision else []
    parts += ["## Models and agreement of the peers\n", *_agreement(peers)]
    parts += (
        ["Not measured:\n\n" + "".join(f"- {sentence}\n" for sentence in absent)] if absent else []
    )
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(part for part in parts if part))


def _table(header, rows):
    """Return a Markdown table; cells are text or numbers (three digits)."""
    lines = [header, ["---"] * len(header), *rows]
    return "".join("| " + " | ".join(_cell(cell) for cell in line) + " |\n" for line in lines)


def _cell(value):
    return three_digits(value) if isinstance(value, float) else str(value)


def _ratio(row):
    """Return "median (min to max)"."""
    middle, low, high = (three_digits(row[f"ratio_{name}"]) for name in ("median", "min", "max"))
    return f"{middle} ({low} to {high})"


def _own_times(rows):
    """Return the table of ours: CPU s per simulated s by case, ns per step, share of the peak."""
    cases = list(dict.fromkeys(row["case"] for row in rows if row["unit"] == SECONDS))
    lines = []
    for quantity in dict.fromkeys(row["quantity"] for row in rows if row["unit"] == SECONDS):
        found = {
            case: [row for row in rows if (row["case"], row["quantity"]) == (case, quantity)]
            for case in cases
        }
        lines.append((_short(quantity), *(_own_time(found[case]) for case in cases)))
    return _table(("runs", *cases), lines)


def _own_time(rows):
    """Return the cell of a case: s per simulated s, ns per step, share of the FMA peak."""
    costs = [row["ours_median"] for row in rows if row["unit"] == SECONDS]
    steps = [
        row["ours_median"] for row in rows if row["unit"] == NANOSECONDS and row["peer"] != PEAK
    ]
    shares = [100.0 * row["ratio_median"] for row in rows if row["peer"] == PEAK]
    parts = [three_digits(float(np.median(costs)))] if costs else []
    parts += [f"{np.median(steps):.0f}"] if steps else []
    parts += [f"{share:.2g} %" for share in shares]
    return ", ".join(parts)


def _ratios(rows):
    """Return the table of the peers: CPU time over ours by case, for each way that ours ran."""
    rows = [row for row in rows if row["unit"] == SECONDS and row["quantity"] in COMPARED]
    cases = list(dict.fromkeys(row["case"] for row in rows))
    found = {
        (row["peer"], row["case"], row["quantity"]): three_digits(row["ratio_median"])
        for row in rows
    }
    peers = dict.fromkeys(row["peer"] for row in rows)
    lines = [(peer, *(_both(found, peer, case) for case in cases)) for peer in peers]
    return _table(("peer", *cases), lines)


def _both(found, peer, case):
    """Return the cell of a peer and a case: the ratio to one run; to a batch of eight."""
    ratios = [found.get((peer, case, way), "-") for way in COMPARED]
    return "" if set(ratios) == {"-"} else "; ".join(ratios)


def _short(quantity):
    """Return how ours ran; every time is that of one run."""
    return quantity.removesuffix(", per run")


def _growth(growth):
    """Return the table of all curves, one in a line."""
    curves = {}
    for row in growth:
        curves.setdefault(row["varied"], []).append(row)
    lines = [
        (
            f"{varied}: {GROWTH[varied]}",
            ", ".join(f"{point['value']:g}" for point in points),
            ", ".join(three_digits(point["ns_per_step_median"]) for point in points),
        )
        for varied, points in curves.items()
    ]
    return _table(("varied", "values", "ns per step and run"), lines)


def _cores(rows):
    """Return the sentence of two processes against one."""
    return "".join(
        f"Two processes on two cores do {_ratio(row)} times the work of one.\n"
        for row in rows
        if row["peer"] == "ours, one process"
    )


def _agreement(peers):
    """Yield a paragraph of what the peers solve and a sentence on their largest differences."""
    alike = {}
    for row in peers:
        alike.setdefault(row["note"], {})[f"{row['peer']} {row['version']}"] = None
    yield "".join(f"- {'; '.join(codes)}: {note}.\n" for note, codes in alike.items())
    if not peers:
        return
    largest = [
        f"{name.replace('_', ' ')} {max(row[name] for row in peers):.0e}"
        f" (limit {peers[0][f'{name}_tolerance']:.0e})"
        for name in NAMES
    ]
    yield f"Largest relative difference of a peer from ours: {', '.join(largest)}.\n"
    failed = {
        f"{row['peer']}, {row['case']}: {row['failure'] or row['agrees']}"
        for row in peers
        if row["failure"] or row["agrees"] != "yes"
    }
    yield "".join(f"- {sentence}\n" for sentence in sorted(failed))
