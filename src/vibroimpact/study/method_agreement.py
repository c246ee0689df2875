"""The consistency table: all methods on all cases, their scatter over seeds, their agreement.

Rows are dicts with the columns of estimate.table_rows. k (N/m) and c (N s/m) are per support of a
group in one direction; NaN is unresolved.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations

import numpy as np

from vibroimpact.identify.estimate import METHODS

COMPARED = ("lscf", "ods", "broadband")  # one of each of the three independent kinds of method
COMPARED_DAMPING = ("lscf", "broadband")  # a shape tells no damping
# Largest relative distance of a stiffness from the median of the three, and of two dampings from
# each other, over the smaller.
AGREEMENT = 0.25
VERDICTS = ("agree", "spread", "unresolved")
SUMMARY_COLUMNS = (
    "gap_m",
    "load_rms_N",
    "load_over_gap",
    "group",
    "direction",
    "method",
    "k_median",
    "k_low",
    "k_high",
    "c_median",
    "c_low",
    "c_high",
    "ratio",
    "verdict_k",
    "verdict_c",
    "reason",
    "flag",
)
COLLAPSE_COLUMNS = (
    "group",
    "direction",
    "method",
    "load_over_gap",
    "k_smallest",
    "k_largest",
    "gaps",
    "k_ratio",
)


def consistency_rows(tables: Iterable[list[dict]]) -> list[dict]:
    """Return the rows of all cases, ordered by gap (largest first), load, seed and method.

    Rows of one method keep their order, that of the groups and directions.
    """
    rows = [row for table in tables for row in table]
    return sorted(
        rows,
        key=lambda row: (
            -row["gap_m"],
            row["load_rms_N"],
            row["seed"],
            METHODS.index(row["method"]),
        ),
    )


def summary_rows(rows: list[dict]) -> list[dict]:
    """Return the rows of consistency_summary.csv: statistics over seeds.

    There is a row per gap, load, group, direction and method. k and c: median, smallest and largest
    over seeds. A median needs a resolved value of at least half the seeds; fewer would be a chance
    selection.
    ratio: k_median over the median of the k_median of the three compared methods.
    verdict_k: "agree" when the three compared methods are resolved and within 25 % of their median,
        "spread" when they are resolved and not, else "unresolved".
    verdict_c: likewise of the two methods that tell c; they agree when they differ by at most 25 %
        of the smaller.
    A verdict stands in the rows of the methods that were compared, and is empty in all others.
    reason: why k or c is not resolved; empty where both are, or where the method never tells c.
    flag: what makes the values of one or more seeds doubtful, and in how many, see identify.guards.
    """
    summary = []
    for place, methods in _by_place(rows).items():
        spans = {
            method: {"k": _span(cases, "k_N_per_m"), "c": _span(cases, "c_N_s_per_m")}
            for method, cases in methods.items()
        }
        stiffness = [spans[method]["k"][0] for method in COMPARED if method in spans]
        centre, verdict_k = stiffness_verdict(stiffness)
        verdict_c = damping_verdict(
            [spans[method]["c"][0] for method in COMPARED_DAMPING if method in spans]
        )
        gap_m, load_rms_N, group, direction = place
        for method, span in spans.items():
            values = (
                gap_m,
                load_rms_N,
                load_rms_N / gap_m,
                group,
                direction,
                method,
                *span["k"],
                *span["c"],
                span["k"][0] / centre,
                verdict_k if method in COMPARED else "",
                verdict_c if method in COMPARED_DAMPING else "",
                _reason(methods[method], span),
                _flag(methods[method]),
            )
            summary.append(dict(zip(SUMMARY_COLUMNS, values, strict=True)))
    return summary


def _by_place(rows: list[dict]) -> dict[tuple, dict[str, list[dict]]]:
    """Return {(gap, load, group, direction): {method: rows of the seeds}}."""
    places: dict[tuple, dict[str, list[dict]]] = {}
    for row in rows:
        place = (row["gap_m"], row["load_rms_N"], row["group"], row["direction"])
        places.setdefault(place, {}).setdefault(row["method"], []).append(row)
    return places


def _span(cases: list[dict], column: str) -> tuple[float, float, float]:
    """Return (median, smallest, largest) of the resolved values.

    NaN where less than half of the cases are resolved.
    """
    values = np.array([row[column] for row in cases], dtype=float)
    resolved = values[np.isfinite(values)]
    if 2 * resolved.size < values.size or resolved.size == 0:
        return np.nan, np.nan, np.nan
    return float(np.median(resolved)), float(resolved.min()), float(resolved.max())


def stiffness_verdict(medians: Sequence[float]) -> tuple[float, str]:
    """Return (median of the three, verdict) of the compared methods' medians of k."""
    if len(medians) < len(COMPARED) or not np.all(np.isfinite(medians)):
        return np.nan, "unresolved"
    centre = float(np.median(medians))
    near = np.all(np.abs(np.array(medians) - centre) <= AGREEMENT * centre)
    return centre, "agree" if near else "spread"


def damping_verdict(medians: Sequence[float]) -> str:
    """Return the verdict of the medians of c of the methods that tell it."""
    if len(medians) < len(COMPARED_DAMPING) or not np.all(np.isfinite(medians)):
        return "unresolved"
    near = all(
        abs(one - other) <= AGREEMENT * min(abs(one), abs(other))
        for one, other in combinations(medians, 2)
    )
    return "agree" if near else "spread"


def _reason(cases: list[dict], span: dict[str, tuple]) -> str:
    """Return why k or c of a method is not resolved, from the reasons of its seeds."""
    if np.isfinite(span["k"][0]):
        if np.isfinite(span["c"][0]) or cases[0]["method"] not in COMPARED_DAMPING:
            return ""
        column = "c_N_s_per_m"
    else:
        column = "k_N_per_m"
    missing = [row for row in cases if not np.isfinite(row[column])]
    reasons = [str(row.get("reason") or "") for row in missing]
    stated = next((reason for reason in reasons if reason), "no value")
    if len(missing) == len(cases):
        return stated
    return f"not resolved in {len(missing)} of {len(cases)} seeds: {stated}"


def _flag(cases: list[dict]) -> str:
    """Return the first flag of the seeds and in how many there is one."""
    flags = [str(row["flag"]) for row in cases if row.get("flag")]
    return f"{len(flags)} of {len(cases)} seeds: {flags[0]}" if flags else ""


def collapse_rows(summary: list[dict], points_per_gap: int = 2) -> list[dict]:
    """Return how well the curves k(load / gap) of the gaps fall on one curve.

    A structure with impacts is homogeneous of degree one, so that k depends on load / gap alone.
    k_median of each gap is interpolated, linearly in both logarithms and within its own range, at
    the load / gap of all gaps. Rows are those with values of at least points_per_gap gaps, with the
    columns COLLAPSE_COLUMNS: k and load_over_gap in N/m.
    """
    curves: dict[tuple, dict[float, list[tuple[float, float]]]] = {}
    for row in summary:
        if row["k_median"] > 0.0:
            place = (row["group"], row["direction"], row["method"])
            points = curves.setdefault(place, {}).setdefault(row["gap_m"], [])
            points.append((row["load_over_gap"], row["k_median"]))
    order = sorted(curves, key=lambda place: METHODS.index(place[2]))
    return [row for place in order for row in _collapse_of(place, curves[place], points_per_gap)]


def _collapse_of(
    place: tuple, curves: dict[float, list[tuple[float, float]]], points_per_gap: int
) -> list[dict]:
    """Return the rows of one group, direction and method."""
    rows = []
    logs = {gap: np.log(np.array(sorted(points))).T for gap, points in curves.items()}
    for level in sorted({point for levels, _ in logs.values() for point in levels}):
        values = [
            np.interp(level, *log)
            for log in logs.values()
            if log[0][0] - 1e-9 <= level <= log[0][-1] + 1e-9
        ]
        if len(values) >= points_per_gap:
            low, high = float(np.exp(min(values))), float(np.exp(max(values)))
            found = (*place, float(np.exp(level)), low, high, len(values), high / low)
            rows.append(dict(zip(COLLAPSE_COLUMNS, found, strict=True)))
    return rows
