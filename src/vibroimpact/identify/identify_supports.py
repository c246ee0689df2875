"""All identification methods on one case with several supports, each for itself.

The broadband comparison and the shapes give the stiffness and damping of every group of supports in
every direction that the force reaches. The poles move these by the smallest step that gives the
main mode the measured pole.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr

from vibroimpact.config.stage_settings import ConfigPart

from .broadband import NEEDS_FORCE
from .case_estimates import LOWEST_CORRELATION, LOWEST_MAC, ONE_SENSOR, with_doubts, without_damping
from .estimate import Estimate, mark_weak, unresolved
from .graded_supports import graded_supports
from .observed_case import ObservedCase, or_none
from .operational_pole import OperationalPole
from .peak import PeakFit
from .pole_step import step_to_pole
from .support_fit import SupportSearch, inverse_information
from .supports_by_shapes import ShapeComparison, ShapesFit, block_shapes
from .supports_by_spectra import SpectraComparison, SpectraFit
from .supports_tube import SupportsTube

SHAPE_LOSS = 0.1  # loss factor of the supports at the start of the search by shapes


class SupportsCase(ObservedCase):
    """The spectra of one case, and the fit of each method to them.

    by_shapes, by_spectra, peaks, pole, shape: of the methods, None for each that found nothing. The
        peaks and the pole need the structure on the supports that spectra or shapes gave.
    """

    def __init__(self, spectra: xr.Dataset, tube: SupportsTube, identification: ConfigPart) -> None:
        super().__init__(spectra, tube.layout, identification)
        self.tube = tube
        self.search = SupportSearch(tube.layout.stiffness_range, 2.0 * np.pi * self.peak[0])
        self.by_shapes = or_none(self._by_shapes)
        self.by_spectra = or_none(self._by_spectra, self.by_shapes)
        start = self.by_spectra or self.by_shapes
        if start is not None:
            supports = start.values.k, start.values.c
            self.peaks = self.peak_fits(tube.other_modes(*supports))
            self.pole = or_none(lambda: self.operational_pole(tube.cross_spectra(*supports)))
        self.shape = or_none(self.main_shape, self.peaks["peak_25th"], 1)

    def _by_spectra(self, shapes: ShapesFit | None) -> SpectraFit | None:
        """Return the SpectraFit, or None if the force is not known or has no power in the band.

        The supports of the shapes are one more start: spectra alone have more false minima.
        """
        tube = self.tube
        values = self.outputs[:, :, tube.layout.broadband_bins]
        if not values.any() or not self.force_known:  # no bins, no motion, or no force
            return None
        segments = (values.real**2 + values.imag**2).swapaxes(0, 1)
        moving = segments.any(axis=(0, 2))  # a dead sensor, or one at a node
        fine, bins = (observed.outputs(moving) for observed in tube.at_broadband)
        comparison = SpectraComparison(
            tube.structure, fine, tube.layout.kernel, segments[:, moving]
        )
        coarse = partial(comparison.coarse_cost, bins)
        starts = self.search.coarse_starts(coarse, len(tube.directions))
        if shapes is not None:
            starts.append((np.log(shapes.values.k), SHAPE_LOSS))
        found = comparison.fit(self.search, starts, tube.lowest_stable_damping, self.averages)
        curve = np.full((len(moving), values.shape[-1]), np.nan)
        curve[moving] = found.curve
        return replace(found, curve=curve)

    def _by_shapes(self) -> ShapesFit | None:
        """Return the ShapesFit, or None if nothing along the line moves, or one point does."""
        tube, layout = self.tube, self.layout
        if len(self.line) < 2 or not np.any(tube.model.line_shapes[tube.structure.modes]):
            return None
        measured = block_shapes(self.line, self.line_frequency, layout.kernel)
        fine, bins = tube.at_line
        at_bins = replace(measured, weights=measured.weights[:, layout.kernel.bins])
        force = layout.excited(self.line_frequency)
        coarse = ShapeComparison(tube.structure, bins, at_bins, self.search, force)
        starts = self.search.coarse_starts(coarse.cost, len(tube.directions), (SHAPE_LOSS,))
        force = layout.excited(tube.structure.frequency[fine.part])
        comparison = ShapeComparison(tube.structure, fine, measured, self.search, force)
        return comparison.fit(starts, tube.lowest_stable_damping)


def estimates_of_supports(case: SupportsCase) -> list[Estimate]:
    """Return the Estimates of all methods for every direction, method by method."""
    found: list[Estimate] = []
    for method, fit in {**case.peaks, "lscf": case.pole}.items():
        estimates = _estimates_by_pole(case, method, fit)
        found += [with_doubts(each, fit, case.layout.seen_band_Hz) for each in estimates]
    return found + _estimates_by_shapes(case) + _estimates_by_spectra(case)


def _unresolved(case: SupportsCase, method: str, note: str, *pole: float) -> list[Estimate]:
    return [unresolved(method, note, *pole).at(direction) for direction in case.tube.directions]


def _estimates_by_pole(
    case: SupportsCase, method: str, fit: PeakFit | OperationalPole | None
) -> list[Estimate]:
    """Return the Estimates of the step that a pole adds to the broadband comparison."""
    if fit is None:
        return _unresolved(case, method, "no resonance could be fitted to the main peak")
    main = fit.frequency, fit.damping_ratio
    if case.by_spectra is None:
        note = f"a pole alone tells no support from others; {_why(case)}"
        return _unresolved(case, method, note, *main)
    found = case.by_spectra.found
    scattered = bool(np.any(found.covariance))
    if not scattered:  # spectra without scatter: the shape of the covariance, without a size
        jacobian = case.by_spectra.values.jacobian
        found = replace(found, covariance=inverse_information(jacobian))
    step = step_to_pole(case.tube.structure, found, (*main, fit.covariance))
    if step is None:
        return _unresolved(case, method, "no supports give the main mode this pole", *main)
    if not scattered:
        step = replace(step, covariance=np.zeros_like(step.covariance))
    return graded_supports(method, step, case.tube.structure, case.search, *main)


def _why(case: SupportsCase) -> str:
    """Return why there is no broadband comparison."""
    if not case.force_known:
        return NEEDS_FORCE
    if not case.layout.frequency[case.layout.broadband_bins].size:
        return "the force has no power in the band of the comparison"
    return "no supports have these spectra"


def _estimates_by_shapes(case: SupportsCase) -> list[Estimate]:
    """Return the Estimates of the shapes: k alone."""
    fit = case.by_shapes
    if fit is None:
        still = "no supports have the shapes of the shape line"
        return _unresolved(case, "ods", ONE_SENSOR if len(case.line) < 2 else still)
    estimates = graded_supports("ods", fit.found, case.tube.structure, case.search)
    if fit.mac < LOWEST_MAC:
        estimates = [mark_weak(item, f"mean MAC only {fit.mac:.2f}") for item in estimates]
    return estimates


def _estimates_by_spectra(case: SupportsCase) -> list[Estimate]:
    """Return the Estimates of the broadband comparison."""
    fit = case.by_spectra
    if fit is None:
        return _unresolved(case, "broadband", _why(case))
    graded = graded_supports("broadband", fit.found, case.tube.structure, case.search)
    ends = zip(graded, fit.values.c_at_edge, strict=True)
    estimates = [without_damping(each) if at_edge else each for each, at_edge in ends]
    if fit.correlation < LOWEST_CORRELATION:
        note = f"smallest correlation of a sensor only {fit.correlation:.2f}"
        estimates = [mark_weak(item, note) for item in estimates]
    return estimates
