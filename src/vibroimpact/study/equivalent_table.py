"""The table of a study that answers: which stiffness and damping for which support.

There is a row per gap, load, group of supports and direction. The recommended k and c are the
median of the compared methods' medians; the secant values of the simulated contact forces serve as
a check.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from .method_agreement import COMPARED, Span, by_place, compared_spans, place_columns, verdict
from .reasons import NOT_MOVED, bound_text, reason

EQUIVALENT_COLUMNS = (
    *("gap_m", "load_rms_N", "load_over_gap", "group", "direction"),
    *("k_N_per_m", "k_low", "k_high", "c_N_s_per_m", "c_low", "c_high"),
    *("secant_k_N_per_m", "secant_c_N_s_per_m", "agreement_k", "agreement_c"),
    *("reason_k", "reason_c", "flag", "k_bound", "contact_fraction"),
)
VALUES = {"k": "k_N_per_m", "c": "c_N_s_per_m"}  # columns
# Of every table that answers: answer_digest of the configuration that it is of.
DIGEST_COLUMN = "config_digest"
NO_SPAN: Span = (np.nan, np.nan, np.nan)


def equivalent_rows(summary: list[dict], unreached: Sequence[tuple[str, str]] = ()) -> list[dict]:
    """Return the rows of equivalent.csv from those of consistency_summary.csv.

    A stiffness needs two of the three compared methods, a damping one of the two. With several
    supports the pole only corrects the result of the spectra, so that the two are one reading: the
    shape must then resolve the stiffness too, if it does so at any load. low and high are the
    smallest and largest value of these methods over all seeds. If methods differ by more than 25 %
    with disjoint intervals there is no recommended value. If a value is not resolved, it is NaN and
    the reason says why; k_bound (N/m) is the upper bound of k if it does not differ from 0. flag:
    the doubts about the values of the compared methods.

    unreached: (group, direction) that the force does not move; they get rows without values.
    """
    places = {
        place: {method: row for method, (row,) in methods.items()}
        for place, methods in by_place(summary).items()
    }
    several = len({place[2:] for place in places}) > 1
    seen = {
        place[2:]
        for place, methods in places.items()
        if "ods" in methods and np.isfinite(methods["ods"]["k_median"])
    }
    rows = [
        _row(place, methods, several, several and place[2:] in seen)
        for place, methods in places.items()
    ]
    for gap_m, load_rms_N in dict.fromkeys(place[:2] for place in places):
        for group, direction in unreached:
            rows.append(_empty((gap_m, load_rms_N, group, direction), NOT_MOVED))
    return sorted(rows, key=lambda row: (-row["gap_m"], row["load_rms_N"]))


def _row(place: tuple, methods: dict[str, dict], several: bool, shape_needed: bool) -> dict:
    """Return the row of one gap, load, group and direction.

    several: whether supports are identified each for itself.
    shape_needed: whether the stiffness must be resolved by the shape.
    """
    spans = {quantity: compared_spans(methods, quantity, several) for quantity in "kc"}
    if shape_needed and np.isnan(spans["k"].get("ods", NO_SPAN)[0]):
        spans["k"].pop("lscf", None)  # one reading with the broadband comparison
    agreement = {quantity: verdict(spans[quantity], quantity) for quantity in "kc"}
    k = recommended(spans["k"], agreement["k"])
    c = recommended(spans["c"], agreement["c"]) if np.isfinite(k[0]) else NO_SPAN
    bound = (
        np.nan if np.isfinite(k[0]) or agreement["k"] == "differ" else _bound(methods, spans["k"])
    )
    reasons = {
        quantity: reason(quantity, methods, spans[quantity], agreement[quantity])
        for quantity in "kc"
    }
    touching = next(iter(methods.values())).get("contact_fraction", np.nan)
    if np.isfinite(bound):
        reasons["k"] = bound_text(bound, float(touching))
    secant = methods.get("secant", {"k_median": np.nan, "c_median": np.nan})
    row = _empty(place, "") | {
        "secant_k_N_per_m": secant["k_median"],
        "secant_c_N_s_per_m": secant["c_median"],
        "agreement_k": agreement["k"],
        "agreement_c": agreement["c"] if np.isfinite(k[0]) else "unresolved",
        "reason_k": reasons["k"],
        "reason_c": reasons["c" if np.isfinite(k[0]) else "k"],
        "flag": _flags(methods),
        "k_bound": bound,
        "contact_fraction": touching,
    }
    row |= dict(zip(("k_N_per_m", "k_low", "k_high"), k, strict=True))
    row |= dict(zip(("c_N_s_per_m", "c_low", "c_high"), c, strict=True))
    return row


def _empty(place: tuple, reason: str) -> dict:
    """Return a row without values."""
    row: dict = dict.fromkeys(EQUIVALENT_COLUMNS, np.nan) | place_columns(place)
    row.update(reason_k=reason, reason_c=reason, flag="")
    return row | dict.fromkeys(("agreement_k", "agreement_c"), "unresolved")


def recommended(spans: Mapping[str, Span], agreement: str) -> Span:
    """Return (median of the methods' medians, smallest, largest value), NaN if there is none."""
    if agreement in ("unresolved", "differ"):
        return NO_SPAN
    found = np.array([span for span in spans.values() if np.isfinite(span[0])])
    return float(np.median(found[:, 0])), float(found[:, 1].min()), float(found[:, 2].max())


def _bound(methods: dict[str, dict], spans: Mapping[str, Span]) -> float:
    """Return the upper bound of k: the least bound of a method, and no less than others resolve."""
    bounds = [float(methods[name].get("k_bound", np.nan)) for name in spans]
    bounds = [value for value in bounds if np.isfinite(value)]
    resolved = [span[2] for span in spans.values() if np.isfinite(span[0])]
    return max([min(bounds), *resolved]) if bounds else np.nan


def _flags(methods: dict[str, dict]) -> str:
    """Return the flags of the compared methods, each once, and the caution of the cases."""
    parts: dict[str, list[str]] = {}
    for name in COMPARED:
        if name in methods and (text := methods[name].get("flag", "")):
            parts.setdefault(text, []).append(name)
    stated = [f"{', '.join(names)}: {text}" for text, names in parts.items()]
    return "; ".join(filter(None, [*stated, next(iter(methods.values())).get("caution", "")]))
