"""One estimate of the equivalent support by one method, and when it may be believed."""

from dataclasses import asdict, dataclass, replace

import numpy as np

PEAK_METHODS = ("peak_half", "peak_quarter", "peak_25th")
METHODS = (*PEAK_METHODS, "lscf", "ods", "broadband", "statistical_linearisation", "secant")
QUALITIES = ("ok", "weak", "unresolved")

FREQUENCY_ERROR = (
    0.003  # one-sigma relative error of a model's modal frequency, nothing else being wrong with it
)
# A stiffness is told from none at all when it exceeds what the model's error gives at two sigma and
# chance at four: a study reads hundreds of cases, and at k = 0 none of them may claim a support.
MODEL_SIGMAS, CHANCE_SIGMAS = 2.0, 4.0
WEAK_ABOVE, UNRESOLVED_ABOVE = (
    0.25,
    0.5,
)  # relative standard error, model's and statistical together


@dataclass(frozen=True)
class Estimate:
    """Equivalent support of one case by one method.

    k (N/m) and c (N s/m) per support, NaN where unresolved, with their statistical standard errors;
    c comes on top of the modal damping and may be negative. frequency (Hz, undamped) and
    damping_ratio of the pole behind it, NaN where there is none. quality: ok, weak or unresolved,
    and note says why; it judges k with the model's error included.
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


def unresolved(method, note, frequency=np.nan, damping_ratio=np.nan):
    """Return an Estimate that claims nothing but the pole it may have."""
    return Estimate(
        method,
        np.nan,
        np.nan,
        frequency=frequency,
        damping_ratio=damping_ratio,
        quality="unresolved",
        note=note,
    )


def graded(estimate, model_error, model_error_free, stiffness_range, c_error_limit=np.inf):
    """Return the estimate with its quality: k and c become NaN where they are not resolved.

    model_error: standard error of k (N/m) that an imperfect model causes at the estimate;
    model_error_free: the same near k = 0. stiffness_range (N/m): where the method looked.
    c_error_limit: standard error of c (N s/m) above which c is not resolved.
    """
    k, error = estimate.k, np.hypot(estimate.k_standard_error, model_error)
    if not np.isfinite(k) or not np.isfinite(error):
        return unresolved(
            estimate.method,
            _joined("no finite support has this feature", estimate.note),
            estimate.frequency,
            estimate.damping_ratio,
        )
    # Both errors come from the same sensitivity: what chance would have done near k = 0 scales as
    # the model's error does.
    chance = estimate.k_standard_error * min(1.0, model_error_free / model_error)
    floor = MODEL_SIGMAS * model_error_free + CHANCE_SIGMAS * chance
    reason = ""
    if k < floor:
        reason = f"k = {k:.3g} N/m can not be told from 0 (least {floor:.3g})"
    elif not stiffness_range[0] <= k <= stiffness_range[1]:
        reason = f"k = {k:.3g} N/m is outside the range"
    elif error > UNRESOLVED_ABOVE * k:
        reason = f"standard error {error / k:.0%} of k"
    if reason:
        return unresolved(
            estimate.method,
            _joined(reason, estimate.note),
            estimate.frequency,
            estimate.damping_ratio,
        )
    if error > WEAK_ABOVE * k:
        estimate = weakened(estimate, f"standard error {error / k:.0%} of k")
    if estimate.c_standard_error > c_error_limit:
        note = _joined(
            f"c = {estimate.c:.3g} +- {estimate.c_standard_error:.2g} N s/m not resolved",
            estimate.note,
        )
        estimate = replace(estimate, c=np.nan, c_standard_error=np.nan, note=note)
    return estimate


def weakened(estimate, note):
    """Return the estimate with quality weak and a note why; an unresolved one stays unresolved."""
    quality = "weak" if estimate.quality == "ok" else estimate.quality
    return replace(estimate, quality=quality, note=_joined(estimate.note, note))


def table_rows(estimates, attributes):
    """Return one dict per Estimate with the columns of consistency.csv. attributes: gap_m (m),
    load_rms_N (N), seed of the case.
    """
    rows = []
    for estimate in estimates:
        values = asdict(estimate)
        rows.append(
            {
                "gap_m": float(attributes["gap_m"]),
                "load_rms_N": float(attributes["load_rms_N"]),
                "load_over_gap": float(attributes["load_rms_N"]) / float(attributes["gap_m"]),
                "seed": int(attributes["seed"]),
                "method": values["method"],
                "k_N_per_m": values["k"],
                "k_standard_error": values["k_standard_error"],
                "c_N_s_per_m": values["c"],
                "c_standard_error": values["c_standard_error"],
                "frequency_Hz": values["frequency"],
                "damping_ratio": values["damping_ratio"],
                "quality": values["quality"],
            }
        )
    return rows


def _joined(*notes):
    return "; ".join(note for note in notes if note)
