"""The tables of the benchmark as rows, and their files."""

import csv
import os

import numpy as np

from evidence.benchmarks.problem import RATE

COLUMNS = (
    "case",
    "quantity",
    "unit",
    "ours_median",
    "peer",
    "peer_median",
    "ratio_median",
    "ratio_min",
    "ratio_max",
)
GROWTH_COLUMNS = (
    "varied",
    "value",
    "modes",
    "contact_points",
    "supports",
    "batch",
    "duration_s",
    "contact_fraction",
    "clock",
    "ns_per_step_median",
    "ns_per_step_min",
    "ns_per_step_max",
    "s_per_simulated_s_median",
)
PEER_COLUMNS = (
    "case",
    "peer",
    "version",
    "simulated_s",
    "contact_fraction",
    "linear",
    "linear_tolerance",
    "first_impacts",
    "first_impacts_tolerance",
    "rms",
    "rms_tolerance",
    "agrees",
    "failure",
    "note",
)
MACHINE_COLUMNS = ("what", "value")
WORDS = (
    "case",
    "quantity",
    "unit",
    "peer",
    "version",
    "agrees",
    "failure",
    "note",
    "varied",
    "clock",
)  # columns that hold no number
SECONDS, NANOSECONDS = "CPU s per simulated s", "ns per step"


def benchmark_rows(pairs):
    """Return [{column: value}] of Pairs: CPU seconds per simulated second; ns per step where the
    peer does the same step.

    A ratio is the peer's time over ours, pair by pair: how many times faster ours is. Against the
    FMA peak it is the fraction of it used.
    """
    rows = []
    for pair in pairs:
        ours, theirs = np.array(pair.ours), np.array(pair.theirs)
        units = [(SECONDS, 1.0)] if not pair.bound else []
        units += [(NANOSECONDS, 1.0e9 / RATE)] if pair.same_step else []
        rows += [
            _row(pair.case, pair.quantity, unit, factor * ours, pair.peer, factor * theirs)
            for unit, factor in units
        ]
    return rows


def cores_rows(points, case):
    """Return the row of two processes against one, from the Growth of `processes`; [] without
    them.
    """
    by_count = {
        point.value: np.array(point.cost) for point in points if point.varied == "processes"
    }
    if set(by_count) != {1, 2}:
        return []
    return [
        _row(
            case,
            "two processes on two cores",
            "wall s per simulated s",
            by_count[2],
            "ours, one process",
            by_count[1],
        )
    ]


def growth_rows(points):
    """Return [{column: value}] of Growth points."""
    return [
        {
            "varied": point.varied,
            "value": point.value,
            "modes": point.modes,
            "contact_points": point.contact_points,
            "supports": point.supports,
            "batch": point.batch,
            "duration_s": point.duration_s,
            "contact_fraction": point.contact_fraction,
            "clock": point.clock,
            "ns_per_step_median": float(np.median(point.ns_per_step)),
            "ns_per_step_min": float(min(point.ns_per_step)),
            "ns_per_step_max": float(max(point.ns_per_step)),
            "s_per_simulated_s_median": float(np.median(point.cost)),
        }
        for point in points
    ]


def write_csv(path, columns, rows):
    """Write rows ({column: value}) as CSV; numbers with six digits. Raises ValueError for a row
    with other columns.
    """
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            if set(row) != set(columns):
                raise ValueError(f"{path}: columns {sorted(row)}, expected {sorted(columns)}")
            writer.writerow(
                {
                    name: f"{value:.6g}" if isinstance(value, float) else value
                    for name, value in row.items()
                }
            )


def read_csv(path):
    """Return [{column: text}] of a CSV file, [] where there is none."""
    if not os.path.exists(path):
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def typed(rows):
    """Return rows with text that is a number, but for versions and names, as a number: whole ones
    as int.
    """
    return [
        {
            name: value if name in WORDS or not isinstance(value, str) else _number(value)
            for name, value in row.items()
        }
        for row in rows
    ]


def _number(text):
    """Return the number that a text is, or the text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def three_digits(value):
    """Return a number with three digits, and no power of ten where people write none."""
    return f"{value:.0f}" if 1.0e3 <= abs(value) < 1.0e6 else f"{value:.3g}"


def _row(case, quantity, unit, ours, peer, theirs):
    """Return the row of two series measured in pairs."""
    ratio = theirs / ours
    spread = [float(of(ratio)) for of in (np.median, np.min, np.max)]
    values = (case, quantity, unit, float(np.median(ours)), peer, float(np.median(theirs)), *spread)
    return dict(zip(COLUMNS, values, strict=True))
