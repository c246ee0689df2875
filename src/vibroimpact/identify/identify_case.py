"""All identification methods on one case: from its spectra and model to estimates and curves."""

from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.identify.linear.support_groups import acts_on_all, reached_supports
from vibroimpact.integration.energy_limit import ENERGY_RESIDUALS
from vibroimpact.reduction.modal_model import ModalModel

from .broadband import NEEDS_FORCE, BroadbandFit, identify_broadband
from .case_curves import case_curves, supports_curves
from .case_estimates import (
    comparison_estimates,
    estimate_from_broadband,
    estimate_from_pole,
    estimate_from_shape,
)
from .estimate import Estimate, unresolved
from .guards import GUARDED, guarded, unusable_channels
from .identify_supports import SupportsCase, estimates_of_supports
from .observed_case import ObservedCase, or_none
from .ods import ShapeMatch, match_shape
from .peak import PeakFit
from .reference_tube import ReferenceTube
from .secant import MOMENTS
from .spectra_layout import spectra_layout
from .supports_tube import SupportsTube

# Variables of the two files that identify_case uses.
RECORD_READ = (*MOMENTS, *ENERGY_RESIDUALS, *GUARDED)
SPECTRA_READ = (
    *("sensor_spectra_re", "sensor_spectra_im", "line_spectra_re", "line_spectra_im"),
    "effective_averages",
)
FEWEST_SHAPE_BINS = 3
FEWEST_SHAPE_POINTS = 2

# Each built once per process for the same model and layout (and groups).
reference_tube = lru_cache(maxsize=2)(ReferenceTube)
supports_tube = lru_cache(maxsize=2)(SupportsTube)


def identify_case(
    config: ConfigPart, model: ModalModel, record: xr.Dataset | None, spectra: xr.Dataset
) -> tuple[list[Estimate], xr.Dataset]:
    """Return (estimates, dataset of the curves behind them) of one case.

    A method that cannot resolve the support returns an unresolved estimate with a note. So do all
    if the energy balance of the record is open, see guards.

    config: with structure.section, excitation, spectra and identification.
    record: statistics of the case (secant.MOMENTS, the residuals of the energy balance if it has
        them, attributes load_rms_N and gap_m). None for a measured case: the methods that need
        its contacts are left out.
    spectra: dataset of study.case_spectra. If its attribute `force` is "unknown", broadband is
        not resolved. A variable force_psd (low_frequency,) is the relative PSD of the force.
    """
    directions, modes = reached_supports(model, config.identification.groups)
    layout = spectra_layout(config, spectra)
    if len(directions) > 1 or not acts_on_all(directions[0], model, modes):
        tube = supports_tube(model, config.identification.groups, layout)
        case = SupportsCase(spectra, tube, config.identification)
        estimates, curves = estimates_of_supports(case), supports_curves(case)
    else:
        estimates, curves = _identify_all_alike(
            ObservedCase(spectra, layout, config.identification), reference_tube(model, layout)
        )
        estimates = [estimate.at(directions[0]) for estimate in estimates]
    if record is not None:
        estimates += comparison_estimates(config, model, record, directions)
    averages, search_Hz = float(spectra["effective_averages"]), config.identification.peak_search_Hz
    unusable = unusable_channels(spectra)
    return guarded(estimates, record, averages, search_Hz, unusable), curves


def _identify_all_alike(
    case: ObservedCase, tube: ReferenceTube
) -> tuple[list[Estimate], xr.Dataset]:
    """Return (estimates, curves) of supports that all have the same k and c."""
    case.peaks = case.peak_fits(tube.other_modes)
    case.pole = case.operational_pole(tube.cross_spectra)
    match = or_none(_matched_shape, case, tube, case.peaks["peak_25th"])
    broad = or_none(_broadband, case, tube)
    poles = {**case.peaks, "lscf": case.pole}
    estimates = [estimate_from_pole(method, fit, tube) for method, fit in poles.items()]
    estimates.append(estimate_from_shape(match, tube, case.averages))
    estimates.append(
        estimate_from_broadband(broad, tube)
        if case.force_known
        else unresolved("broadband", NEEDS_FORCE)
    )
    more: dict[str, Any] = {}
    if match is not None:
        more |= {"mac_k": match.k_grid, "mac": match.mac_grid, "best_mac": match.mac}
    more["map_k"], more["map_c"], _ = tube.broadband_map
    if broad is not None:
        more |= {
            "correlation": broad.correlation_map,
            "best_correlation": broad.correlation,
            "broadband_curve": broad.curve,
        }
    return estimates, case_curves(case, more)


def _matched_shape(
    case: ObservedCase, tube: ReferenceTube, fit: PeakFit | None
) -> ShapeMatch | None:
    """Return the match of the shape around the main peak; None without one, or on one point."""
    if len(case.line) < FEWEST_SHAPE_POINTS:
        return None
    measured = case.main_shape(fit, FEWEST_SHAPE_BINS)
    if fit is None or measured is None:
        return None
    members = tube.shape_members(fit.damping_ratio, np.sqrt(fit.covariance[1, 1]))
    match = match_shape(measured, tube.at_line, tube.mode_shapes, members)
    case.shape = measured
    return match


def _broadband(case: ObservedCase, tube: ReferenceTube) -> BroadbandFit | None:
    """Return the BroadbandFit, None if the force is not known."""
    if not case.force_known:
        return None
    values = case.outputs[case.layout.broadband][:, case.layout.broadband_bins]
    segments = values.real**2 + values.imag**2
    psd, kernel = segments.mean(axis=0), case.layout.kernel
    family = tube.at_broadband, kernel, tube.broadband_map, tube.lowest_stable_damping
    return identify_broadband(psd, *family, case.averages, segments)
