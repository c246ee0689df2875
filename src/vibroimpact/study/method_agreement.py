"""The consistency table: all methods on all cases, their scatter over seeds, their agreement.

Rows are dicts with the columns of estimate.table_rows. k (N/m) and c (N s/m) are per support; NaN
is unresolved.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product

import numpy as np
import xarray as xr

from vibroimpact.identify.estimate import METHODS, QUALITIES

COMPARED = ("lscf", "ods", "broadband")  # one of each of the three independent kinds of method
AGREEMENT = 0.25  # largest relative distance from the median of the three
VERDICTS = ("agree", "spread", "unresolved")
SUMMARY_COLUMNS = (
    "gap_m",
    "load_rms_N",
    "load_over_gap",
    "method",
    "k_median",
    "k_low",
    "k_high",
    "c_median",
    "c_low",
    "c_high",
    "ratio",
    "verdict",
)
COLLAPSE_COLUMNS = ("method", "load_over_gap", "k_smallest", "k_largest", "gaps", "k_ratio")


def consistency_rows(tables: Iterable[list[dict]]) -> list[dict]:
    """Return the rows of all cases, ordered by gap (largest first), load, seed and method."""
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
    """Return the rows of consistency_summary.csv: statistics over seeds per gap, load and method.

    k and c: median, smallest and largest over seeds. A median needs a resolved value of at least
    half the seeds; fewer would be a chance selection.
    ratio: k_median over the median of the k_median of the three compared methods.
    verdict: one for each gap and load. "agree" when the three methods are resolved and within 25 %
    of their median, "spread" when they are resolved and not, else "unresolved".
    """
    groups: dict[tuple[float, float], dict[str, list[dict]]] = {}
    for row in rows:
        methods = groups.setdefault((row["gap_m"], row["load_rms_N"]), {})
        methods.setdefault(row["method"], []).append(row)
    summary = []
    for (gap_m, load_rms_N), methods in groups.items():
        spans = {
            method: {"k": _span(cases, "k_N_per_m"), "c": _span(cases, "c_N_s_per_m")}
            for method, cases in methods.items()
        }
        centre, verdict = _verdict(
            [spans[method]["k"][0] for method in COMPARED if method in spans]
        )
        for method, span in spans.items():
            values = (
                gap_m,
                load_rms_N,
                load_rms_N / gap_m,
                method,
                *span["k"],
                *span["c"],
                span["k"][0] / centre,
                verdict,
            )
            summary.append(dict(zip(SUMMARY_COLUMNS, values, strict=True)))
    return summary


def _span(cases: list[dict], column: str) -> tuple[float, float, float]:
    """Return (median, smallest, largest) of the resolved values.

    NaN where less than half of the cases are resolved.
    """
    values = np.array([row[column] for row in cases], dtype=float)
    resolved = values[np.isfinite(values)]
    if 2 * resolved.size < values.size or resolved.size == 0:
        return np.nan, np.nan, np.nan
    return float(np.median(resolved)), float(resolved.min()), float(resolved.max())


def _verdict(medians: list[float]) -> tuple[float, str]:
    """Return (median of the three, verdict) of the compared methods' medians of k."""
    if len(medians) < len(COMPARED) or not np.all(np.isfinite(medians)):
        return np.nan, "unresolved"
    centre = float(np.median(medians))
    near = np.all(np.abs(np.array(medians) - centre) <= AGREEMENT * centre)
    return centre, "agree" if near else "spread"


def collapse_rows(summary: list[dict], points_per_gap: int = 2) -> list[dict]:
    """Return how well the curves k(load / gap) of the gaps fall on one curve.

    A structure with impacts is homogeneous of degree one, so that k depends on load / gap alone.
    k_median of each gap is interpolated, linearly in both logarithms and within its own range, at
    the load / gap of all gaps. Rows are those with values of at least points_per_gap gaps, with the
    columns COLLAPSE_COLUMNS: k and load_over_gap in N/m.
    """
    rows = []
    for method in METHODS:
        curves: dict[float, list[tuple[float, float]]] = {}
        for row in summary:
            if row["method"] == method and row["k_median"] > 0.0:
                curves.setdefault(row["gap_m"], []).append((row["load_over_gap"], row["k_median"]))
        logs = {gap: np.log(np.array(sorted(points))).T for gap, points in curves.items()}
        for place in sorted({point for log_place, _ in logs.values() for point in log_place}):
            values = [
                np.interp(place, *log)
                for log in logs.values()
                if log[0][0] - 1e-9 <= place <= log[0][-1] + 1e-9
            ]
            if len(values) >= points_per_gap:
                low, high = np.exp(min(values)), np.exp(max(values))
                rows.append(
                    {
                        "method": method,
                        "load_over_gap": float(np.exp(place)),
                        "k_smallest": float(low),
                        "k_largest": float(high),
                        "gaps": len(values),
                        "k_ratio": float(high / low),
                    }
                )
    return rows


def consistency_dataset(rows: list[dict], summary: list[dict]) -> xr.Dataset:
    """Return both tables as one Dataset, qualities and verdicts as flags.

    Estimates have dimensions (gap, load, seed, method), the summary (gap, load, method).
    """
    gaps = sorted({row["gap_m"] for row in rows}, reverse=True)
    loads = sorted({row["load_rms_N"] for row in rows})
    seeds = sorted({row["seed"] for row in rows})
    place = {key: (gaps.index(key[0]), loads.index(key[1])) for key in product(gaps, loads)}
    columns = {
        "k_N_per_m": ("k", "N m-1"),
        "k_standard_error": ("k_standard_error", "N m-1"),
        "c_N_s_per_m": ("c", "N s m-1"),
        "c_standard_error": ("c_standard_error", "N s m-1"),
        "frequency_Hz": ("frequency", "Hz"),
        "damping_ratio": ("damping_ratio", "1"),
    }
    data: dict[str, tuple] = {}
    dims = ("gap", "load", "seed", "method")
    shape = (len(gaps), len(loads), len(seeds), len(METHODS))
    for column, (name, unit) in columns.items():
        about = {"units": unit, "long_name": column.replace("_", " ")}
        data[name] = (dims, np.full(shape, np.nan), about)
    data["quality"] = (
        dims,
        np.full(shape, len(QUALITIES) - 1, np.int8),
        _flags(QUALITIES, "quality of the estimate"),
    )
    for row in rows:
        index = (
            *place[row["gap_m"], row["load_rms_N"]],
            seeds.index(row["seed"]),
            METHODS.index(row["method"]),
        )
        for column, (name, _) in columns.items():
            data[name][1][index] = row[column]
        data["quality"][1][index] = QUALITIES.index(row["quality"])
    for column in SUMMARY_COLUMNS[4:-1]:
        unit = {"k": "N m-1", "c": "N s m-1"}.get(column[0], "1")
        values = np.full((len(gaps), len(loads), len(METHODS)), np.nan)
        for row in summary:
            at = place[row["gap_m"], row["load_rms_N"]]
            values[(*at, METHODS.index(row["method"]))] = row[column]
        about = {"units": unit, "long_name": column.replace("_", " ") + " over seeds"}
        data[column] = (("gap", "load", "method"), values, about)
    verdicts = np.full((len(gaps), len(loads)), len(VERDICTS) - 1, np.int8)
    for row in summary:
        verdicts[place[row["gap_m"], row["load_rms_N"]]] = VERDICTS.index(row["verdict"])
    data["verdict"] = (
        ("gap", "load"),
        verdicts,
        _flags(VERDICTS, "agreement of lscf, ods and broadband"),
    )
    coords = {
        "gap": ("gap", gaps, {"units": "m", "long_name": "radial gap"}),
        "load": ("load", loads, {"units": "N", "long_name": "RMS load"}),
        "seed": seeds,
        "method": list(METHODS),
    }
    return xr.Dataset(data, coords, {"title": "vibroimpact consistency of the identifications"})


def _flags(meanings: Sequence[str], long_name: str) -> dict:
    return {
        "units": "1",
        "long_name": long_name,
        "flag_values": np.arange(len(meanings), dtype=np.int8),
        "flag_meanings": " ".join(meanings),
    }
