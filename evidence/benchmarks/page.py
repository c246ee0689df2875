"""docs/performance.md: the tables of a benchmark in words and columns, written anew at every
run.
"""

import numpy as np

from evidence.benchmarks.check import CHECK_S, FIRST_IMPACTS_S, NAMES
from evidence.benchmarks.pairs import PEAK
from evidence.benchmarks.problem import BAND_HZ, GAP_M, LOAD_N, RATE, SMALL_BASIS
from evidence.benchmarks.table import NANOSECONDS, SECONDS, three_digits, typed

RECORD_S = 49.0
SMALL_TO_HZ = SMALL_BASIS["basis.free_modes_to_Hz"]

INTRODUCTION = f"""# Performance

Written by `make benchmark`; do not edit. Numbers of `results/benchmark/benchmark.csv`, \
`growth.csv`, `peers.csv` and `machine.csv`.

The problem is the study's stand-in tube: a force in {BAND_HZ[0]:g} to {BAND_HZ[1]:g} Hz at 45 \
degrees of the bend, two plates
of five contact points, gap {GAP_M * 1e3:.3f} mm. At {LOAD_N:g} N RMS, the study's highest load, \
a plate bears a force half
of the time. "Modes" are free modes and the residual vectors of the contacts: 99 in the study, 61 \
with
free modes to {SMALL_TO_HZ:g} Hz. Residual vectors reach 130 kHz and set the step of every \
explicit method; one
case therefore has free modes alone.

- Every code solves the same problem. Its displacement at three sensors must agree before its time
  counts: without contact ({CHECK_S:g} s), over the first impacts ({FIRST_IMPACTS_S:g} s), and in \
RMS. Obstacles are off the
  axis, so that both directions touch.
- Times are CPU time of one core without compilation. Ours include set-up, output filter, \
statistics,
  energies and records (`integrate_batch`); the peers keep three displacements. Forces are made
  beforehand.
- A ratio comes from runs that alternate in one process: median (smallest to largest). Slow peers \
run a
  short stretch with less contact, which favours them.
- Ours integrates eight runs in a 512-bit vector. One run alone costs nearly as much as eight. \
The plain
  loop, and JAX without its batch, take one case after the other.
- Ours, the plain loop, JAX and Exudyn step with Newmark, {RATE} steps per second. "At the \
study's step"
  is the scheme and rate of `config/study.yaml` ([what a step is worth](#what-a-step-is-worth)).
- The FMA peak is that of the core for the step's own arithmetic, without output filter, \
statistics and
  energies (`evidence/benchmarks/peak.py`).
- Absolute times hold for this machine. Compare ratios.
"""

GROWTH = {
    "modes": "Batch of 8; the residual vectors of the contacts stay, free modes are added.",
    "contact points": "Batch of 8, free modes alone, points of the two plates together.",
    "supports": "Batch of 8, free modes alone, five points each.",
    "runs side by side": "Per run.",
    "duration, s": "Batch of 8; set-up and the filter's run-out weigh on short records.",
    "processes": "Wall-clock time per run of a batch of 8 in each process, a core each.",
}


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
        "## Machine\n",
        _table(("what", "on this machine"), machine.items()),
    ]
    for case in dict.fromkeys(row["case"] for row in rows):
        parts += [f"## {case}\n", _times(case, rows), _steps(case, rows), _peak(case, rows)]
    parts += ["## Growth\n", *_growth(growth), _cores(rows)] if growth else []
    parts += [work_precision] if work_precision else []
    parts += ["## What each peer solves, and whether it agrees\n", *_agreement(peers)]
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


def _span(seconds):
    """Return seconds as people say them."""
    for limit, factor, unit in (
        (120.0, 1.0, "s"),
        (7200.0, 60.0, "min"),
        (float("inf"), 3600.0, "h"),
    ):
        if seconds < limit:
            return f"{seconds / factor:.3g} {unit}"


def _times(case, rows):
    """Return the table of CPU seconds and ratios of a case."""
    rows = [row for row in rows if row["case"] == case and row["unit"] == SECONDS]
    quantities = list(dict.fromkeys(row["quantity"] for row in rows))
    lines = [
        (f"ours, {quantity}", cost, _span(RECORD_S * cost), *[""] * len(quantities))
        for quantity, cost in _ours(rows).items()
    ]
    for peer in dict.fromkeys(row["peer"] for row in rows):
        found = {row["quantity"]: row for row in rows if row["peer"] == peer}
        cost = next(iter(found.values()))["peer_median"]
        lines.append(
            (
                peer,
                cost,
                _span(RECORD_S * cost),
                *[_ratio(found[quantity]) if quantity in found else "" for quantity in quantities],
            )
        )
    return _table(
        (
            "code",
            "CPU s per simulated s",
            f"{RECORD_S:g} s record",
            *(f"/ ours, {quantity}" for quantity in quantities),
        ),
        lines,
    )


def _steps(case, rows):
    """Return the sentence of nanoseconds per step."""
    rows = [
        row
        for row in rows
        if row["case"] == case and row["unit"] == NANOSECONDS and row["peer"] != PEAK
    ]
    parts = [
        f"ours, {quantity.partition(',')[0]}, {value:.0f}"
        for quantity, value in _ours(rows).items()
    ]
    parts += [
        f"{peer} {value:.0f}"
        for peer, value in {row["peer"]: row["peer_median"] for row in rows}.items()
    ]
    return f"Nanoseconds per step and run: {'; '.join(parts)}.\n" if rows else ""


def _peak(case, rows):
    """Return the sentence of the fraction of the FMA peak."""
    found = [row for row in rows if row["case"] == case and row["peer"] == PEAK]
    shares = [
        [f"{100.0 * row[f'ratio_{name}']:.2g}" for name in ("median", "min", "max")]
        for row in found
    ]
    parts = [
        f"{middle} % ({low} to {high} %) as {row['quantity'].partition(',')[0]}"
        for row, (middle, low, high) in zip(found, shares, strict=True)
    ]
    return (
        f"At the FMA peak a step takes {found[0]['peer_median']:.0f} ns. Ours uses"
        f" {', '.join(parts)}.\n"
        if found
        else ""
    )


def _growth(growth):
    """Yield a table per curve."""
    for varied in dict.fromkeys(row["varied"] for row in growth):
        others = [name for name in ("modes", "contact points") if name != varied]
        lines = [
            (
                row["value"],
                *(row[name.replace(" ", "_")] for name in others),
                100.0 * row["contact_fraction"],
                row["ns_per_step_median"],
                f"{three_digits(row['ns_per_step_min'])} to {three_digits(row['ns_per_step_max'])}",
            )
            for row in growth
            if row["varied"] == varied
        ]
        yield f"{GROWTH.get(varied, '')}\n"
        yield _table(
            (varied, *others, "time in contact, %", "ns per step and run", "smallest to largest"),
            lines,
        )


def _cores(rows):
    """Return the sentence of two processes against one."""
    return "".join(
        f"Two processes on two cores do {_ratio(row)} times the work of one.\n"
        for row in rows
        if row["peer"] == "ours, one process"
    )


def _agreement(peers):
    """Yield a paragraph of what the peers solve and a table of the checks."""
    alike = {}
    for row in peers:
        alike.setdefault(row["note"], {})[f"{row['peer']} {row['version']}"] = None
    yield "".join(f"- {'; '.join(codes)}: {note}.\n" for note, codes in alike.items())
    lines = [
        (
            row["case"],
            row["peer"],
            row["simulated_s"],
            100.0 * row["contact_fraction"],
            *(f"{row[name]:.0e}" for name in NAMES),
            row["failure"] or row["agrees"],
        )
        for row in peers
    ]
    limits = (
        [f"{name.replace('_', ' ')} (to {peers[0][f'{name}_tolerance']:.0e})" for name in NAMES]
        if peers
        else NAMES
    )
    yield _table(
        ("case", "peer", "s per timed run", "time in contact, %", *limits, "agrees"), lines
    )


def _ours(rows):
    """Return {quantity: the middle of the medians of ours beside each peer}."""
    found = {}
    for row in rows:
        found.setdefault(row["quantity"], []).append(row["ours_median"])
    return {quantity: float(np.median(values)) for quantity, values in found.items()}
