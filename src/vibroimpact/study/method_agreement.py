"""The consistency table: all methods on all cases, their scatter over seeds, their agreement.

Rows are dicts with the columns of estimate.table_rows. k (N/m) and c (N s/m) are per support of a
group in one direction; NaN is unresolved.
"""

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np

from vibroimpact.identify.estimate import METHODS

# One of each kind of method. The pole and the shape both read the main peak, the broadband PSD the
# whole band.
COMPARED = ("lscf", "ods", "broadband")
COMPARED_OF = {"k": COMPARED, "c": ("lscf", "broadband")}  # a shape carries no damping
FEWEST = {"k": 2, "c": 1}  # methods that must resolve a value; a single stiffness is not confirmed
# Largest relative distance of a stiffness from the median of three; of two values from each other,
# over the smaller.
AGREEMENT = 0.25
# partial: those that resolve the value agree; spread: they are farther apart, with intervals that
# overlap; differ: with disjoint ones, so that there is no recommended value.
VERDICTS = ("agree", "partial", "spread", "differ", "unresolved")
WEAK = "weak: "  # how the reason of a value begins that is resolved, but weakly
FEWEST_GAPS = 2  # with values at one load over gap, to say whether they collapse
Span = tuple[float, float, float]  # median, smallest, largest; NaN if not resolved
COLLAPSE_COLUMNS = (
    *("group", "direction", "method"),
    *("load_over_gap", "k_smallest", "k_largest", "gaps", "k_ratio"),
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
    over seeds. A median needs a resolved value without a flag of at least half the seeds; fewer
    would be a chance selection.
    ratio: k_median over the median of the k_median of the three compared methods.
    verdict_k, verdict_c: of the compared methods, see verdict; empty in the rows of all others.
    reason: why k or c is not resolved, or k is weak; empty if both are, or if the method
        never gives c.
    flag: the doubts about the values of one or more seeds, and in how many, see identify.guards.
    k_bound: N/m, the upper bound of k if it does not differ from 0, the largest over seeds.
    contact_fraction: median over seeds. caution: further remarks on the cases.
    """
    places = by_place(rows)
    several = len({place[2:] for place in places}) > 1
    summary: list[dict] = []
    for place, methods in places.items():
        found = {name: _method_row(place, name, cases) for name, cases in methods.items()}
        stiffness, damping = (compared_spans(found, quantity, several) for quantity in "kc")
        medians = [span[0] for span in stiffness.values()]
        whole = len(medians) == len(COMPARED) and np.all(np.isfinite(medians))
        centre = float(np.median(medians)) if whole else np.nan
        for name, row in found.items():
            row["ratio"] = row["k_median"] / centre
            for quantity, spans in (("k", stiffness), ("c", damping)):
                if name in COMPARED_OF[quantity]:
                    row[f"verdict_{quantity}"] = verdict(spans, quantity)
        summary += found.values()
    return summary


def _method_row(place: tuple, method: str, cases: list[dict]) -> dict:
    """Return the row of a method without its verdicts."""
    k, c = _span(cases, "k_N_per_m"), _span(cases, "c_N_s_per_m")
    touching = [row["contact_fraction"] for row in cases]
    return {
        **place_columns(place),
        "method": method,
        **dict(zip(("k_median", "k_low", "k_high"), k, strict=True)),
        **dict(zip(("c_median", "c_low", "c_high"), c, strict=True)),
        "ratio": np.nan,  # this and the verdicts are set by the methods together
        "verdict_k": "",
        "verdict_c": "",
        "reason": _reason(cases, {"k": k, "c": c}),
        "flag": counted([str(row["flag"]) for row in cases]),
        "k_bound": _bound(cases, k),
        "contact_fraction": float(np.median(touching)),
        "caution": counted([str(row["caution"]) for row in cases]),
    }


def compared_spans(methods: Mapping[str, dict], quantity: str, several: bool) -> dict[str, Span]:
    """Return the Span of k or c of each compared method.

    methods: {method: row of consistency_summary.csv} of one place.
    several: whether the supports are identified each for itself. The pole then only corrects the
        result of the broadband comparison, and has no value if that does not resolve k.
    """
    spans = {
        name: tuple(
            float(methods[name][f"{quantity}_{part}"]) for part in ("median", "low", "high")
        )
        for name in COMPARED_OF[quantity]
        if name in methods
    }
    if several and np.isnan(methods.get("broadband", {}).get("k_median", np.nan)):
        spans.pop("lscf", None)
    return spans  # type: ignore[return-value]


def verdict(spans: Mapping[str, Span], quantity: str) -> str:
    """Return one of VERDICTS on the spans of the compared methods.

    Stiffnesses agree within 25 % of the median of three; two stiffnesses or dampings when they
    differ by at most 25 % of the smaller.
    """
    found = np.array([span for span in spans.values() if np.isfinite(span[0])]).reshape(-1, 3)
    if len(found) < FEWEST[quantity]:
        return "unresolved"
    medians = found[:, 0]
    if len(found) > 2:
        apart = np.abs(medians - np.median(medians)).max() > AGREEMENT * np.median(medians)
    else:
        apart = len(found) > 1 and _distance(*medians) > AGREEMENT
    if not apart:
        return "agree" if len(found) == len(COMPARED_OF[quantity]) else "partial"
    disputed = any(
        _distance(one[0], other[0]) > AGREEMENT and max(one[1], other[1]) > min(one[2], other[2])
        for one, other in combinations(found, 2)
    )
    return "differ" if disputed else "spread"


def _distance(one: float, other: float) -> float:
    """Return the difference of two values over the smaller; infinite if one is 0."""
    smaller = min(abs(one), abs(other))
    return abs(one - other) / smaller if smaller > 0.0 else np.inf


def place_of(row: Mapping) -> tuple[float, float, str, str]:
    """Return (gap in m, load in N, group, direction) of a row of any table."""
    return row["gap_m"], row["load_rms_N"], row["group"], row["direction"]


def place_columns(place: tuple) -> dict:
    """Return the columns of a table that state a place."""
    gap_m, load_rms_N, group, direction = place
    over = {"gap_m": gap_m, "load_rms_N": load_rms_N, "load_over_gap": load_rms_N / gap_m}
    return {**over, "group": group, "direction": direction}


def by_place(rows: Iterable[dict]) -> dict[tuple, dict[str, list[dict]]]:
    """Return {place: {method: its rows}}."""
    places: dict[tuple, dict[str, list[dict]]] = {}
    for row in rows:
        places.setdefault(place_of(row), {}).setdefault(row["method"], []).append(row)
    return places


def _span(cases: list[dict], column: str) -> Span:
    """Return (median, smallest, largest) of the resolved values without a flag.

    NaN if less than half of the cases have one.
    """
    values = np.array([np.nan if row["flag"] else row[column] for row in cases], dtype=float)
    resolved = values[np.isfinite(values)]
    if 2 * resolved.size < values.size or resolved.size == 0:
        return np.nan, np.nan, np.nan
    return float(np.median(resolved)), float(resolved.min()), float(resolved.max())


def _bound(cases: list[dict], k: Span) -> float:
    """Return the upper bound of k in all seeds if it does not differ from 0 in most; else NaN."""
    bounds = np.array([row["k_bound"] for row in cases], dtype=float)
    if np.isfinite(k[0]) or 2 * np.isfinite(bounds).sum() < len(bounds):
        return np.nan
    return float(np.nanmax([*bounds, *(row["k_N_per_m"] for row in cases)]))


def _reason(cases: list[dict], span: dict[str, tuple]) -> str:
    """Return why k or c of a method is not resolved, or weak, from the reasons of its seeds."""
    if np.isfinite(span["k"][0]):
        if np.isfinite(span["c"][0]) or cases[0]["method"] not in COMPARED_OF["c"]:
            return _weak(cases)
        column = "c_N_s_per_m"
    else:
        column = "k_N_per_m"
    missing = [row for row in cases if row["flag"] or not np.isfinite(row[column])]
    reasons = [str(row["flag"] or row["reason"] or "") for row in missing]
    stated = next((reason for reason in reasons if reason), "no value")
    if len(missing) == len(cases):
        return stated
    return f"not resolved in {len(missing)} of {len(cases)} seeds: {stated}"


def _weak(cases: list[dict]) -> str:
    """Return why the k of a method is weak in more than half of the seeds that resolve it."""
    found = [row for row in cases if np.isfinite(row["k_N_per_m"]) and not row["flag"]]
    weak = [row for row in found if row["quality"] == "weak"]
    return f"{WEAK}{weak[0]['reason']}" if 2 * len(weak) > len(found) else ""


def counted(texts: Sequence[str]) -> str:
    """Return the first text of the seeds and in how many there is one, or nothing."""
    there = [text for text in texts if text]
    return f"{len(there)} of {len(texts)} seeds: {there[0]}" if there else ""


def collapse_rows(summary: list[dict]) -> list[dict]:
    """Return rows on the collapse of the curves k(load / gap) of the gaps onto one curve.

    A structure with impacts is homogeneous of degree one, so that k depends on load / gap alone.
    k_median of each gap is interpolated, linearly in both logarithms and within its own range, at
    the load / gap of all gaps. Rows are those with values of at least FEWEST_GAPS gaps, with the
    columns COLLAPSE_COLUMNS: k and load_over_gap in N/m.
    """
    curves: dict[tuple, dict[float, list[tuple[float, float]]]] = {}
    for row in summary:
        if row["k_median"] > 0.0:
            place = (row["group"], row["direction"], row["method"])
            points = curves.setdefault(place, {}).setdefault(row["gap_m"], [])
            points.append((row["load_over_gap"], row["k_median"]))
    order = sorted(curves, key=lambda place: METHODS.index(place[2]))
    return [row for place in order for row in _collapse_of(place, curves[place])]


def _collapse_of(place: tuple, curves: dict[float, list[tuple[float, float]]]) -> list[dict]:
    """Return the rows of one group, direction and method."""
    rows = []
    logs = {gap: np.log(np.array(sorted(points))).T for gap, points in curves.items()}
    for level in sorted({point for levels, _ in logs.values() for point in levels}):
        values = [
            np.interp(level, *log)
            for log in logs.values()
            if log[0][0] - 1e-9 <= level <= log[0][-1] + 1e-9
        ]
        if len(values) >= FEWEST_GAPS:
            low, high = float(np.exp(min(values))), float(np.exp(max(values)))
            found = (*place, float(np.exp(level)), low, high, len(values), high / low)
            rows.append(dict(zip(COLLAPSE_COLUMNS, found, strict=True)))
    return rows
