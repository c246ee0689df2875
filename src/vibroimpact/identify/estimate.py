"""The estimate of an equivalent support by one method, and its quality."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from vibroimpact.identify.linear.support_groups import SupportDirection

PEAK_METHODS = ("peak_half", "peak_quarter", "peak_25th")
# In words, the same in figures and on pages.
METHOD_NAMES = {
    "peak_half": "peak width at 1/2",
    "peak_quarter": "peak width at 1/4",
    "peak_25th": "peak width at 1/25",
    "lscf": "LSCF pole",
    "ods": "deflection shape",
    "broadband": "broadband PSD",
    "statistical_linearisation": "statistical linearisation",
    "secant": "mean secant stiffness",
}
METHODS = tuple(METHOD_NAMES)
QUALITIES = ("ok", "weak", "unresolved")

# Relative standard error of the modal frequencies of a model that is otherwise right.
FREQUENCY_ERROR = 0.003
# A stiffness differs from zero when it exceeds two standard errors of the model plus four of
# chance. Four, because a study has hundreds of cases and at k = 0 none of them may claim a support.
MODEL_SIGMAS, CHANCE_SIGMAS = 2.0, 4.0
BOUND_SIGMAS = 2.0  # of chance, above the value found: upper bound of k if it does not differ
# Relative standard error of k, of the model and of chance together.
WEAK_ABOVE, UNRESOLVED_ABOVE = 0.25, 0.5
EDGE = 0.05  # of ln k: a value so near the edge of the range that was searched is the edge's
# Columns of consistency.csv that have another name than their field.
COLUMNS = {"k": "k_N_per_m", "c": "c_N_s_per_m", "frequency": "frequency_Hz", "note": "reason"}


@dataclass(frozen=True)
class Estimate:
    """Equivalent support of one case by one method.

    k, k_standard_error: N/m per support; NaN if unresolved.
    c, c_standard_error: N s/m, on top of the modal damping; may be negative.
    frequency, damping_ratio: of the pole behind the estimate (Hz, undamped); NaN for none.
    quality: ok, weak or unresolved. It judges k with the error of the model included.
    note: the reason for the quality.
    flag: the doubts about the estimate beyond its standard error, see guards; mostly empty. A
        flagged estimate takes no part in the recommended values.
    k_bound: N/m, the upper bound of k if it does not differ from 0; else NaN.
    contact_fraction: share of time in contact of the support that is touched most; NaN if unknown.
    caution: further remarks on the case, whatever the method.
    group, direction: the supports that share k and c, and the direction that they act in.
    """

    method: str
    k: float
    k_standard_error: float
    c: float = np.nan
    c_standard_error: float = np.nan
    frequency: float = np.nan
    damping_ratio: float = np.nan
    quality: str = "ok"
    note: str = ""
    flag: str = ""
    k_bound: float = np.nan
    contact_fraction: float = np.nan
    caution: str = ""
    group: str = ""
    direction: str = ""

    def at(self, support: SupportDirection) -> "Estimate":
        """Return the estimate as that of a group of supports in one direction."""
        return replace(self, group=support.group, direction=support.direction)


def unresolved(
    method: str, note: str, frequency: float = np.nan, damping_ratio: float = np.nan
) -> Estimate:
    """Return an unresolved Estimate, with the pole it may have."""
    nothing = np.nan, np.nan, np.nan, np.nan
    return Estimate(method, *nothing, frequency, damping_ratio, "unresolved", note)


def grade(
    estimate: Estimate,
    model_error: float,
    model_error_at_zero: float,
    stiffness_range: Sequence[float],
    c_error_limit: float = np.inf,
) -> Estimate:
    """Return the estimate with its quality; k and c become NaN if they are not resolved.

    model_error: standard error of k in N/m that an imperfect model causes.
    model_error_at_zero: the same near k = 0.
    stiffness_range: N/m, that of the search.
    c_error_limit: standard error of c in N s/m above which c is not resolved.
    """
    k, error = estimate.k, np.hypot(estimate.k_standard_error, model_error)
    pole = (estimate.frequency, estimate.damping_ratio)
    if not np.isfinite(k) or not np.isfinite(error):
        note = joined("no finite support has this feature", estimate.note)
        return unresolved(estimate.method, note, *pole)
    # Both errors have the same sensitivity, so the statistical error near k = 0 scales as the
    # model's error does.
    chance = estimate.k_standard_error * min(1.0, model_error_at_zero / model_error)
    floor = MODEL_SIGMAS * model_error_at_zero + CHANCE_SIGMAS * chance
    reason, bound = "", np.nan
    if k < floor:
        bound = max(k, 0.0) + MODEL_SIGMAS * model_error_at_zero + BOUND_SIGMAS * chance
        reason = f"k = {k:.3g} N/m does not differ from 0 (least {floor:.3g})"
    elif not stiffness_range[0] <= k <= stiffness_range[1]:
        reason = f"k = {k:.3g} N/m is outside the range"
    elif edge := edge_of_range(k, stiffness_range):
        reason = edge
    elif error > UNRESOLVED_ABOVE * k:
        reason = f"standard error {error / k:.0%} of k"
    if reason:
        empty = unresolved(estimate.method, joined(reason, estimate.note), *pole)
        return replace(empty, k_bound=bound)
    if error > WEAK_ABOVE * k:
        estimate = mark_weak(estimate, f"standard error {error / k:.0%} of k")
    if estimate.c_standard_error > c_error_limit:
        reason = f"c = {estimate.c:.3g} +- {estimate.c_standard_error:.2g} N s/m not resolved"
        note = joined(reason, estimate.note)
        estimate = replace(estimate, c=np.nan, c_standard_error=np.nan, note=note)
    return estimate


def edge_of_range(k: float, stiffness_range: Sequence[float]) -> str:
    """Return that k (N/m) is not inside the range that was searched, or an empty text."""
    low, high = stiffness_range
    if k < low * np.exp(EDGE):
        return f"k is at or below the lower end of the range, {low:.3g} N/m"
    if k > high * np.exp(-EDGE):
        return f"k is at or above the upper end of the range, {high:.3g} N/m"
    return ""


def flagged(estimate: Estimate, flag: str) -> Estimate:
    """Return the estimate with one more flag; an empty one adds nothing."""
    return replace(estimate, flag=joined(estimate.flag, flag))


def mark_weak(estimate: Estimate, note: str) -> Estimate:
    """Return the estimate with quality weak and a note; an unresolved one stays unresolved."""
    quality = "weak" if estimate.quality == "ok" else estimate.quality
    return replace(estimate, quality=quality, note=joined(estimate.note, note))


def table_rows(estimates: Iterable[Estimate], attributes: Mapping[str, Any]) -> list[dict]:
    """Return one dict per Estimate with the columns of consistency.csv.

    attributes: gap_m (m), load_rms_N (N) and seed of the case.
    """
    gap, load = float(attributes["gap_m"]), float(attributes["load_rms_N"])
    case = {"gap_m": gap, "load_rms_N": load, "load_over_gap": load / gap}
    case["seed"] = int(attributes["seed"])
    rows = []
    for estimate in estimates:
        values = asdict(estimate)
        if estimate.quality == "ok" and np.isfinite(estimate.c):  # nothing to be explained
            values["note"] = ""
        place = {name: values.pop(name) for name in ("group", "direction")}
        named = {COLUMNS.get(name, name): value for name, value in values.items()}
        rows.append({**case, **place, **named})
    return rows


def method_name(method: str) -> str:
    """Return a method in words; one that is not known here by its own name, without underscores."""
    return METHOD_NAMES.get(method, method.replace("_", " "))


def joined(*notes: str) -> str:
    """Return notes as one text, without the empty ones."""
    return "; ".join(note for note in notes if note)
