"""From the fit of each method to one case to graded estimates of the equivalent support."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.identify.linear.support_groups import SupportDirection
from vibroimpact.reduction.modal_model import ModalModel

from .broadband import BroadbandFit
from .equivalent_support import equivalent_support
from .estimate import FREQUENCY_ERROR, Estimate, flagged, grade, joined, mark_weak, unresolved
from .guards import other_mode, peak_not_crossed
from .ods import ShapeMatch
from .operational_pole import OperationalPole
from .peak import PeakFit
from .reference_tube import ReferenceTube
from .secant import secant_support
from .segment_scatter import jackknife_influences, segment_covariance
from .statistical_linearisation import statistical_linearisation

# c is not resolved when its standard error exceeds this fraction of the pole's damping ratio.
DAMPING_RATIO_LIMIT = 0.5
# MAC below which the motion around the peak is no longer one shape of the family.
LOWEST_MAC = 0.9
# Correlation below which the best spectrum of the family does not look like the measured one.
LOWEST_CORRELATION = 0.8
ONE_SENSOR = "one sensor tells no shape"
C_AT_EDGE = "c is at the edge of the family: with less, a mode of the linear tube would be unstable"


def standard_errors(covariance: np.ndarray) -> np.ndarray:
    """Return (parameter,) standard errors, infinite if round-off left a negative variance."""
    variance = np.diag(covariance)
    return np.sqrt(np.where(variance < 0.0, np.inf, variance))


def estimate_from_pole(
    method: str, fit: PeakFit | OperationalPole | None, tube: ReferenceTube
) -> Estimate:
    """Return the Estimate of the pole of a peak, or of LSCF."""
    if fit is None:
        return unresolved(method, "no resonance could be fitted to the main peak")
    support = equivalent_support(tube.modes, fit.frequency, fit.damping_ratio)
    errors = standard_errors(support.jacobian @ fit.covariance @ support.jacobian.T)
    pole = (fit.frequency, fit.damping_ratio)
    estimate = Estimate(method, support.k, float(errors[0]), support.c, float(errors[1]), *pole)
    model_error = abs(support.jacobian[0, 0]) * FREQUENCY_ERROR * fit.frequency
    limit = DAMPING_RATIO_LIMIT * fit.damping_ratio * abs(support.jacobian[1, 1])
    estimate = grade(
        estimate, model_error, tube.pole_error_at_zero, tube.layout.stiffness_range, limit
    )
    if np.isfinite(estimate.k):
        estimate = flagged(estimate, other_mode(tube.model, support.k, support.c, pole))
    return with_doubts(estimate, fit, tube.layout.seen_band_Hz)


def with_doubts(
    estimate: Estimate, fit: PeakFit | OperationalPole | None, seen_band_Hz: Sequence[float]
) -> Estimate:
    """Return the estimate with the flag of a peak that is not crossed, or weak by a doubtful pole.

    seen_band_Hz: in which the force has power and the spectra have bins.
    """
    if isinstance(fit, PeakFit):
        return flagged(estimate, peak_not_crossed(fit, seen_band_Hz))
    if fit is not None and not fit.stable:
        note = f"no single pole is stable from order to order; order {fit.order} taken"
        return mark_weak(estimate, note)
    return estimate


def estimate_from_shape(match: ShapeMatch | None, tube: ReferenceTube, averages: float) -> Estimate:
    """Return the Estimate of a matched shape: k alone, because a shape carries no damping.

    averages: effective degrees of freedom of a bin.
    """
    if match is None:
        few = tube.model.line_shapes.shape[1] < 2
        note = "no peak sets a band inside that of the shape line's spectra"
        return unresolved("ods", ONE_SENSOR if few else note)
    influences = jackknife_influences(match.segment_changes[:, None])
    variance = segment_covariance(influences, averages)[0, 0]
    error = float(np.sqrt(variance + match.damping_change**2))
    estimate = Estimate("ods", match.k, match.k * error)
    model_error = match.k * match.model_error
    estimate = grade(estimate, model_error, tube.shape_error_at_zero, tube.layout.stiffness_range)
    if match.mac < LOWEST_MAC:
        estimate = mark_weak(estimate, f"best MAC only {match.mac:.2f}")
    return estimate


def estimate_from_broadband(fit: BroadbandFit | None, tube: ReferenceTube) -> Estimate:
    """Return the Estimate of the broadband correlation.

    The model's error is that of its first frequency.
    """
    if fit is None:
        return unresolved("broadband", "the correlation has no maximum in the family")
    frequency = tube.first_frequency(fit.k)
    ratio = tube.first_damping_ratio(fit.k) + fit.c * tube.damping_ratio_slope(fit.k)
    model_error = FREQUENCY_ERROR * fit.k / tube.frequency_slope(fit.k)
    errors = standard_errors(fit.covariance)
    estimate = Estimate(
        "broadband", fit.k, float(errors[0]), fit.c, float(errors[1]), frequency, ratio
    )
    limit = DAMPING_RATIO_LIMIT * abs(ratio) / tube.damping_ratio_slope(fit.k)
    estimate = grade(
        estimate, model_error, tube.pole_error_at_zero, tube.layout.stiffness_range, limit
    )
    if fit.c_at_edge:
        estimate = without_damping(estimate)
    if fit.correlation < LOWEST_CORRELATION:
        estimate = mark_weak(estimate, f"correlation only {fit.correlation:.2f}")
    return estimate


def without_damping(estimate: Estimate) -> Estimate:
    """Return the estimate without its c, which is that of the edge of the family."""
    note = joined(estimate.note, C_AT_EDGE)
    return flagged(replace(estimate, c=np.nan, c_standard_error=np.nan, note=note), C_AT_EDGE)


def comparison_estimates(
    config: ConfigPart,
    model: ModalModel,
    record: xr.Dataset,
    directions: Sequence[SupportDirection],
) -> list[Estimate]:
    """Return the Estimates of statistical linearisation and of the secant, for each direction.

    Neither uses the spectrum of a response.
    """
    found = [_linearised(config, model, record, direction) for direction in directions]
    return found + [secant_support(record, model, direction) for direction in directions]


def _linearised(
    config: ConfigPart, model: ModalModel, record: xr.Dataset, direction: SupportDirection
) -> Estimate:
    """Return the Estimate of statistical linearisation."""
    method = "statistical_linearisation"
    if config.excitation.kind != "band_limited":
        return unresolved(method, "needs a force of flat PSD in a band").at(direction)
    load, gap = float(record.attrs["load_rms_N"]), float(record.attrs["gap_m"])
    case = statistical_linearisation(model, load, gap, tuple(config.excitation.band_Hz))
    k, pole = case.stiffness_of(direction), (case.frequency, case.damping_ratio)
    if not np.isfinite(k):
        return unresolved(method, "needs a direction along an axis", *pole).at(direction)
    predicted = Estimate(method, k, 0.0, np.nan, np.nan, *pole).at(direction)
    return predicted if case.settled else mark_weak(predicted, "the iteration did not settle")
