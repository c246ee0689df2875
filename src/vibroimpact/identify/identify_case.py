"""All identification methods on one case: from its spectra and model to estimates and curves."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.excitation.line_force_spectrum import relative_psd
from vibroimpact.geometry.sections import outer_width
from vibroimpact.identify.linear.support_groups import acts_on_all, reached_supports
from vibroimpact.identify.spectra.welch import complex_values, driven_axis
from vibroimpact.integration.energy_limit import ENERGY_RESIDUALS
from vibroimpact.reduction.modal_model import ModalModel

from .broadband import NEEDS_FORCE, UNKNOWN, BroadbandFit, identify_broadband
from .case_curves import case_curves, supports_curves
from .case_estimates import (
    comparison_estimates,
    estimate_from_broadband,
    estimate_from_operational_pole,
    estimate_from_peak,
    estimate_from_shape,
)
from .estimate import Estimate, unresolved
from .guards import GUARDED, guarded
from .identify_supports import SupportsCase, estimates_of_supports
from .ods import DeflectionShape, ShapeMatch, deflection_shape, match_shape
from .operational_pole import OperationalPole, PoleSearch, operational_pole
from .peak import LEVELS, PeakFit, find_peak, fit_peak
from .reference_tube import Bins, ReferenceTube, Sensors
from .secant import MOMENTS
from .segment_scatter import effective_duration
from .solvable import or_none, unusable_channels
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
    if len(directions) > 1 or not acts_on_all(directions[0], model, modes):
        return _identify_each(config, model, record, spectra)
    tube = reference_tube(config, model, spectra)
    case = CaseSpectra(spectra, tube)
    peaks = {
        method: or_none(case.fit_main_peak, level, config.identification.peak_search_Hz)
        for method, level in LEVELS.items()
    }
    pole = or_none(case.operational_pole, config.identification)
    shape = or_none(case.shape, peaks["peak_25th"])
    broad = or_none(case.broadband)
    estimates = [estimate_from_peak(method, fit, tube) for method, fit in peaks.items()]
    estimates += [
        estimate_from_operational_pole(pole, tube),
        estimate_from_shape(shape, tube, case.averages),
        (
            estimate_from_broadband(broad, tube)
            if case.force_known
            else unresolved("broadband", NEEDS_FORCE)
        ),
    ]
    if record is not None:
        estimates += comparison_estimates(config, model, record, directions)
    estimates = [estimate.at(directions[0]) for estimate in estimates]
    return estimates, case_curves(case, peaks, pole, shape, broad)


def _identify_each(
    config: ConfigPart, model: ModalModel, record: xr.Dataset | None, spectra: xr.Dataset
) -> tuple[list[Estimate], xr.Dataset]:
    """Return the results of identify_case, for several unknown supports."""
    tube = _supports_tube(model, config.identification.groups, *_layout(config, spectra))
    case = SupportsCase(spectra, tube, config.identification)
    result = case.fit()
    estimates = estimates_of_supports(case, result)
    if record is not None:
        estimates += comparison_estimates(config, model, record, tube.directions)
    return estimates, supports_curves(case, result)


def reference_tube(config: ConfigPart, model: ModalModel, spectra: xr.Dataset) -> ReferenceTube:
    """Return the ReferenceTube of a model on the bins of spectra.

    It is built once per process for the same model and settings.
    """
    return _reference_tube(model, *_layout(config, spectra))


def _layout(config: ConfigPart, spectra: xr.Dataset) -> tuple:
    """Return (Bins, Sensors, band of the force, band of the comparison, stiffness range, bytes of
    the relative PSD of the force, empty for a white one).
    """
    identification = config.identification
    axis = "." + driven_axis(config.excitation.direction)
    names = tuple(str(name) for name in spectra["driven_sensor"].values)
    sensors = Sensors(
        names=names,
        response=names.index(identification.response_point + axis),
        broadband=names.index(identification.broadband.point + axis),
        references=tuple(names.index(point + axis) for point in identification.lscf.references),
    )
    low, line = spectra["low_frequency"].values, spectra["line_frequency"].values
    spacing = 1.0 / float(spectra.attrs["segment_s"])
    bins = Bins(
        spacing_Hz=spacing,
        highest=low.size - 1,
        line_first=int(round(line[0] / spacing)),
        line_last=int(round(line[-1] / spacing)),
        window=str(spectra.attrs["window"]),
    )
    excitation = config.excitation
    force_band = (0.0, float("inf"))
    if excitation.kind in ("band_limited", "turbulence"):
        force_band = tuple(excitation.band_Hz)
    return (
        bins,
        sensors,
        force_band,
        tuple(identification.broadband.band_Hz),
        tuple(identification.stiffness_range_N_per_m),
        _relative_psd(config, spectra).tobytes(),
    )


def _relative_psd(config: ConfigPart, spectra: xr.Dataset) -> np.ndarray:
    """Return (frequency,) the relative PSD of the force: measured, or of turbulence. Else empty."""
    if "force_psd" in spectra:
        return spectra["force_psd"].values
    if config.excitation.kind != "turbulence":
        return np.zeros(0)
    diameter = outer_width(config.structure.section)
    return relative_psd(config.excitation, diameter, spectra["low_frequency"].values)


@lru_cache(maxsize=2)
def _supports_tube(model, groups, bins, sensors, force_band, broadband_band, k_range, psd):
    reached = reached_supports(model, groups)
    bands = (force_band, broadband_band)
    return SupportsTube(model, reached, bins, sensors, bands, k_range, _numbers(psd))


@lru_cache(maxsize=2)
def _reference_tube(model, bins, sensors, force_band, broadband_band, k_range, psd):
    return ReferenceTube(model, bins, sensors, force_band, broadband_band, k_range, _numbers(psd))


def _numbers(values: bytes) -> np.ndarray | None:
    """Return the numbers of bytes, None for none."""
    return np.frombuffer(values) if values else None


class CaseSpectra:
    """The spectra of one case, and the fit of each method to them."""

    def __init__(self, spectra: xr.Dataset, tube: ReferenceTube) -> None:
        self.tube = tube
        self.averages = float(spectra["effective_averages"])
        self.force_known = spectra.attrs.get("force") != UNKNOWN
        self.frequency = tube.frequency
        self.outputs = complex_values(spectra, "sensor_spectra")
        self.line = complex_values(spectra, "line_spectra")
        self.line_frequency = spectra["line_frequency"].values
        response = self.outputs[tube.sensors.response]
        self.segments = response.real**2 + response.imag**2
        self.psd = self.segments.mean(axis=0)
        self.peak: Any = None  # (frequency, width) in Hz, set by fit_main_peak

    def fit_main_peak(self, level: float, search_Hz: Sequence[float]) -> PeakFit | None:
        """Return the PeakFit of the main peak at a level, or None."""
        self.peak = self.peak or find_peak(self.frequency, self.psd, search_Hz)
        return fit_peak(
            self.frequency,
            self.psd,
            self.tube.kernel,
            level,
            self.peak,
            self.tube.other_modes,
            self.averages,
            self.segments,
        )

    def operational_pole(self, identification: ConfigPart) -> OperationalPole | None:
        """Return the OperationalPole of the main peak, or None."""
        search = PoleSearch(
            self.frequency,
            tuple(identification.lscf.band_Hz),
            self.tube.bins.window,
            identification.lscf.max_order,
        )
        return operational_pole(
            self.outputs,
            self.tube.sensors.references,
            search,
            self.peak,
            self.averages,
            effective_duration(self.averages, self.tube.kernel),
            self.tube.cross_spectra,
        )

    def shape(self, fit: PeakFit | None) -> tuple[DeflectionShape, ShapeMatch] | None:
        """Return the shape of the band above 1/25 of the fitted peak and its match.

        None without a peak, on too few points, or for a band of too few bins.
        """
        if fit is None or len(self.line) < FEWEST_SHAPE_POINTS:
            return None
        edges = np.clip(fit.edges_Hz, self.line_frequency[0], self.line_frequency[-1])
        if edges[1] - edges[0] < FEWEST_SHAPE_BINS * self.tube.bins.spacing_Hz:
            return None
        measured = deflection_shape(self.line, self.line_frequency, tuple(edges))
        members = self.tube.shape_members(fit.damping_ratio, np.sqrt(fit.covariance[1, 1]))
        match = match_shape(measured, self.tube.at_line, self.tube.mode_shapes, members)
        return measured, match

    def broadband(self) -> BroadbandFit | None:
        """Return the BroadbandFit, or None."""
        if not self.force_known:
            return None
        values = self.outputs[self.tube.sensors.broadband][:, self.tube.broadband]
        segments = values.real**2 + values.imag**2
        return identify_broadband(
            segments.mean(axis=0),
            self.tube.at_broadband,
            self.tube.kernel,
            self.tube.broadband_map,
            self.tube.lowest_stable_damping,
            self.averages,
            segments,
        )
