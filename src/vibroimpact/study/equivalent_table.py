"""The table of a study that answers: which stiffness and damping for which support.

There is a row per gap, load, group of supports and direction. The recommended k and c are the
median of the compared methods' medians; the secant values of the simulated contact forces stand
beside them as a check.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from .method_agreement import COMPARED, COMPARED_DAMPING

EQUIVALENT_COLUMNS = (
    "gap_m",
    "load_rms_N",
    "load_over_gap",
    "group",
    "direction",
    "k_N_per_m",
    "k_low",
    "k_high",
    "c_N_s_per_m",
    "c_low",
    "c_high",
    "secant_k_N_per_m",
    "secant_c_N_s_per_m",
    "agreement_k",
    "agreement_c",
    "reason_k",
    "reason_c",
    "flag",
)
FEWEST_METHODS = 2  # of the stiffness; a single reading is not confirmed
NOT_MOVED = "the force does not move the supports in this direction"


def equivalent_rows(summary: list[dict], unreached: Sequence[tuple[str, str]] = ()) -> list[dict]:
    """Return the rows of equivalent.csv from those of consistency_summary.csv.

    A stiffness needs two of the three compared methods, a damping one of the two. With several
    supports the pole only corrects what the spectra say, so that the two are one reading: the shape
    must then resolve the stiffness too, if it does so at any load. low and high are the smallest
    and largest value of these methods over all seeds. Where a value is not resolved, it is NaN and
    the reason says why. flag: what makes the values of the compared methods doubtful.

    unreached: (group, direction) that the force does not move; they get rows without values.
    """
    places: dict[tuple, dict[str, dict]] = {}
    for row in summary:
        place = (row["gap_m"], row["load_rms_N"], row["group"], row["direction"])
        places.setdefault(place, {})[row["method"]] = row
    supports = {place[2:] for place in places}
    seen = {
        place[2:]
        for place, methods in places.items()
        if "ods" in methods and np.isfinite(methods["ods"]["k_median"])
    }
    rows = [
        _row(place, methods, len(supports) > 1 and place[2:] in seen)
        for place, methods in places.items()
    ]
    for gap_m, load_rms_N in dict.fromkeys(place[:2] for place in places):
        for group, direction in unreached:
            rows.append(_empty((gap_m, load_rms_N, group, direction), NOT_MOVED))
    return sorted(rows, key=lambda row: (-row["gap_m"], row["load_rms_N"]))


def _row(place: tuple, methods: dict[str, dict], shape_needed: bool) -> dict:
    """Return the row of one gap, load, group and direction.

    shape_needed: whether the stiffness must be resolved by the shape.
    """
    k = _recommended(methods, "k", COMPARED, FEWEST_METHODS)
    if shape_needed and not np.isfinite(methods.get("ods", {}).get("k_median", np.nan)):
        k = (np.nan, np.nan, np.nan)
    c = _recommended(methods, "c", COMPARED_DAMPING, 1)
    secant = methods.get("secant", {"k_median": np.nan, "c_median": np.nan})
    compared = next((methods[name] for name in COMPARED_DAMPING if name in methods), {})
    values = {
        **_empty(place, ""),
        "k_N_per_m": k[0],
        "k_low": k[1],
        "k_high": k[2],
        "c_N_s_per_m": c[0] if np.isfinite(k[0]) else np.nan,
        "c_low": c[1] if np.isfinite(k[0]) else np.nan,
        "c_high": c[2] if np.isfinite(k[0]) else np.nan,
        "secant_k_N_per_m": secant["k_median"],
        "secant_c_N_s_per_m": secant["c_median"],
        "agreement_k": compared.get("verdict_k", "unresolved"),
        "agreement_c": compared.get("verdict_c", "unresolved"),
    }
    values["reason_k"] = "" if np.isfinite(k[0]) else _reasons(methods, "k_median", COMPARED)
    values["reason_c"] = (
        ""
        if np.isfinite(values["c_N_s_per_m"])
        else values["reason_k"] or _reasons(methods, "c_median", COMPARED_DAMPING)
    )
    flags = {name: methods[name].get("flag", "") for name in COMPARED if name in methods}
    values["flag"] = _stated(flags)
    return values


def _empty(place: tuple, reason: str) -> dict:
    """Return a row without values."""
    gap_m, load_rms_N, group, direction = place
    row: dict = dict.fromkeys(EQUIVALENT_COLUMNS, np.nan)
    row.update(gap_m=gap_m, load_rms_N=load_rms_N, load_over_gap=load_rms_N / gap_m)
    row.update(group=group, direction=direction, reason_k=reason, reason_c=reason)
    row.update(agreement_k="unresolved", agreement_c="unresolved", flag="")
    return row


def _recommended(
    methods: dict[str, dict], quantity: str, compared: Sequence[str], fewest: int
) -> tuple[float, float, float]:
    """Return (median of the methods' medians, smallest, largest value), NaN for too few methods."""
    found = [methods[name] for name in compared if name in methods]
    found = [row for row in found if np.isfinite(row[f"{quantity}_median"])]
    if len(found) < fewest:
        return np.nan, np.nan, np.nan
    return (
        float(np.median([row[f"{quantity}_median"] for row in found])),
        float(min(row[f"{quantity}_low"] for row in found)),
        float(max(row[f"{quantity}_high"] for row in found)),
    )


def _reasons(methods: dict[str, dict], column: str, compared: Sequence[str]) -> str:
    """Return the reasons of the compared methods that give no value, each once."""
    return _stated(
        {
            name: methods[name]["reason"] or "no value"
            for name in compared
            if name in methods and not np.isfinite(methods[name][column])
        }
    )


def _stated(texts: Mapping[str, str]) -> str:
    """Return texts of methods as one, each text once with the methods that say it."""
    parts: dict[str, list[str]] = {}
    for name, text in texts.items():
        if text:
            parts.setdefault(text, []).append(name)
    return "; ".join(f"{', '.join(names)}: {reason}" for reason, names in parts.items())
