"""All identification methods on one case: from its spectra and model to estimates and curves."""

from functools import lru_cache

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
from .guards import GUARDED, guarded
from .identify_supports import SupportsCase, estimates_of_supports
from .observed_case import ObservedCase
from .ods import DeflectionShape, ShapeMatch, match_shape
from .peak import PeakFit
from .reference_tube import ReferenceTube
from .secant import MOMENTS
from .solvable import or_none, unusable_channels
from .spectra_layout import SpectraLayout, spectra_layout
from .supports_tube import SupportsTube

# Variables of the two files that identify_case uses.
RECORD_READ = (*MOMENTS, *ENERGY_RESIDUALS, *GUARDED)
SPECTRA_READ = (
    "sensor_spectra_re",
    "sensor_spectra_im",
    "line_spectra_re",
    "line_spectra_im",
    "effective_averages",
)
FEWEST_SHAPE_BINS = 3
FEWEST_SHAPE_POINTS = 2


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
    estimates, curves = _identify(config, model, record, spectra)
    averages, search_Hz = float(spectra["effective_averages"]), config.identification.peak_search_Hz
    unusable = unusable_channels(spectra)
    return guarded(estimates, record, averages, search_Hz, unusable), curves


def _identify(
    config: ConfigPart, model: ModalModel, record: xr.Dataset | None, spectra: xr.Dataset
) -> tuple[list[Estimate], xr.Dataset]:
    """Return the results of identify_case, before its guards."""
    directions, modes = reached_supports(model, config.identification.groups)
    layout = spectra_layout(config, spectra)
    if len(directions) > 1 or not acts_on_all(directions[0], model, modes):
        tube = supports_tube(model, config.identification.groups, layout)
        case = SupportsCase(spectra, tube, config.identification)
        result = case.fit()
        estimates = estimates_of_supports(case, result)
        curves = supports_curves(case, result)
    else:
        estimates, curves = _identify_all_alike(
            ObservedCase(spectra, layout, config.identification), reference_tube(model, layout)
        )
        estimates = [estimate.at(directions[0]) for estimate in estimates]
    if record is not None:
        estimates += comparison_estimates(config, model, record, directions)
    return estimates, curves


def _identify_all_alike(
    case: ObservedCase, tube: ReferenceTube
) -> tuple[list[Estimate], xr.Dataset]:
    """Return (estimates, curves) of supports that all have the same k and c."""
    peaks = case.peak_fits(tube.other_modes)
    pole = case.operational_pole(tube.cross_spectra)
    shape = or_none(_matched_shape, case, tube, peaks["peak_25th"])
    broad = or_none(_broadband, case, tube)
    poles = {**peaks, "lscf": pole}
    estimates = [estimate_from_pole(method, fit, tube) for method, fit in poles.items()]
    estimates.append(estimate_from_shape(shape, tube, case.averages))
    estimates.append(
        estimate_from_broadband(broad, tube)
        if case.force_known
        else unresolved("broadband", NEEDS_FORCE)
    )
    return estimates, case_curves(tube, peaks, pole, shape, broad)


def _matched_shape(
    case: ObservedCase, tube: ReferenceTube, fit: PeakFit | None
) -> tuple[DeflectionShape, ShapeMatch] | None:
    """Return the shape around the main peak and its match; None without one, or on one point."""
    measured = None
    if len(case.line) >= FEWEST_SHAPE_POINTS:
        measured = case.main_shape(fit, FEWEST_SHAPE_BINS)
    if fit is None or measured is None:
        return None
    members = tube.shape_members(fit.damping_ratio, np.sqrt(fit.covariance[1, 1]))
    return measured, match_shape(measured, tube.at_line, tube.mode_shapes, members)


def _broadband(case: ObservedCase, tube: ReferenceTube) -> BroadbandFit | None:
    """Return the BroadbandFit, None if the force is not known."""
    if not case.force_known:
        return None
    values = case.outputs[case.layout.broadband][:, case.layout.broadband_bins]
    segments = values.real**2 + values.imag**2
    return identify_broadband(
        segments.mean(axis=0),
        tube.at_broadband,
        case.layout.kernel,
        tube.broadband_map,
        tube.lowest_stable_damping,
        case.averages,
        segments,
    )


@lru_cache(maxsize=2)
def reference_tube(model: ModalModel, layout: SpectraLayout) -> ReferenceTube:
    """Return the ReferenceTube, built once per process for the same model and layout."""
    return ReferenceTube(model, layout)


@lru_cache(maxsize=2)
def supports_tube(
    model: ModalModel, groups: str | tuple[tuple[str, ...], ...], layout: SpectraLayout
) -> SupportsTube:
    """Return the SupportsTube, built once per process for the same model, groups and layout."""
    return SupportsTube(model, groups, layout)
