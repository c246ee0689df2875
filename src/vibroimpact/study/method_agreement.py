"""The consistency table: every method on every case, what the seeds scatter, and whether the
independent methods agree.

Rows are dicts with the columns of estimate.table_rows. k (N/m) and c (N s/m) are per support; NaN
is unresolved.
"""

from itertools import product

import numpy as np
import xarray as xr

from vibroimpact.identify.estimate import METHODS, QUALITIES

COMPARED = ("lscf", "ods", "broadband")  # one of each of the three independent identifications
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


def consistency_rows(tables):
    """Return all rows of the cases' tables (lists of rows), ordered by gap (largest first), load,
    seed and method.
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


def summary_rows(rows):
    """Return the rows of consistency_summary.csv: per gap, load and method the median and the range
    over seeds, ratio and verdict.

    A median needs a resolved value of at least half the seeds: otherwise chance picks the seeds
    that speak. ratio: k_median over the median of the three compared methods' k_median; verdict:
    agree when the three are resolved and all within 25 % of their median, spread when they are
    resolved and are not, else unresolved. It is that of the gap and load, the same for all methods.
    """
    groups = {}
    for row in rows:
        groups.setdefault((row["gap_m"], row["load_rms_N"]), {}).setdefault(
            row["method"], []
        ).append(row)
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


def _span(cases, column):
    """Return (median, smallest, largest) of the resolved values, NaN where less than half the cases
    have one.
    """
    values = np.array([row[column] for row in cases], dtype=float)
    resolved = values[np.isfinite(values)]
    if 2 * resolved.size < values.size or resolved.size == 0:
        return (np.nan,) * 3
    return float(np.median(resolved)), float(resolved.min()), float(resolved.max())


def _verdict(medians):
    """Return (median of the three, verdict) of the compared methods' medians of k."""
    if len(medians) < len(COMPARED) or not np.all(np.isfinite(medians)):
        return np.nan, "unresolved"
    centre = float(np.median(medians))
    return centre, (
        "agree" if np.all(np.abs(np.array(medians) - centre) <= AGREEMENT * centre) else "spread"
    )


def collapse_rows(summary, points_per_gap=2):
    """Return how well the gaps fall on one curve: rows of method, load_over_gap (N/m), k_smallest,
    k_largest (N/m), gaps, k_ratio.

    A structure with impacts is homogeneous of degree one, so k depends on load/gap only. Each gap's
    k_median is interpolated (both axes logarithmic, between its own points alone) at the loads/gap
    of all gaps; rows are those where at least points_per_gap gaps speak.
    """
    rows = []
    for method in METHODS:
        curves = {}
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


def consistency_dataset(rows, summary):
    """Return the two tables as one Dataset over (gap, load, seed, method) and (gap, load, method);
    qualities and verdicts as flags.
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
    data, dims = {}, ("gap", "load", "seed", "method")
    shape = (len(gaps), len(loads), len(seeds), len(METHODS))
    for column, (name, unit) in columns.items():
        data[name] = (
            dims,
            np.full(shape, np.nan),
            {"units": unit, "long_name": column.replace("_", " ")},
        )
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
            values[(*place[row["gap_m"], row["load_rms_N"]], METHODS.index(row["method"]))] = row[
                column
            ]
        data[column] = (
            ("gap", "load", "method"),
            values,
            {"units": unit, "long_name": column.replace("_", " ") + " over seeds"},
        )
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


def _flags(meanings, long_name):
    return {
        "units": "1",
        "long_name": long_name,
        "flag_values": np.arange(len(meanings), dtype=np.int8),
        "flag_meanings": " ".join(meanings),
    }
