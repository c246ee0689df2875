"""The spectra of one case as all methods read them, and the fits to their main peak."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np
import xarray as xr

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.identify.linear.modes import PoleError
from vibroimpact.identify.spectra.welch import complex_values

from .broadband import UNKNOWN
from .ods import DeflectionShape, deflection_shape
from .operational_pole import OperationalPole, PoleSearch, operational_pole
from .peak import LEVELS, PeakFit, find_peak, fit_peak
from .segment_scatter import effective_duration
from .spectra_layout import SpectraLayout

Result = TypeVar("Result")


def or_none(method: Callable[..., Result | None], *arguments: object) -> Result | None:
    """Return the result of a method, None if its equations have no solution.

    Spectra without a resonance, of sensors that do not move or that move alike, make matrices
    singular.
    """
    try:
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            return method(*arguments)
    except (np.linalg.LinAlgError, PoleError):
        return None


class ObservedCase:
    """The spectra of one case, on the layout of the structure that they are compared with.

    outputs, line: (sensor, segment, frequency) and (line_point, segment, line_frequency) complex.
    averages: effective degrees of freedom of a bin.
    peak: (frequency, width) of the main peak in Hz.
    peaks, pole, shape: {method: PeakFit or None}, OperationalPole and DeflectionShape of the main
        peak, None if not found.
    """

    def __init__(
        self, spectra: xr.Dataset, layout: SpectraLayout, identification: ConfigPart
    ) -> None:
        self.layout, self.lscf = layout, identification.lscf
        self.averages = float(spectra["effective_averages"])
        self.force_known = spectra.attrs.get("force") != UNKNOWN
        self.outputs = complex_values(spectra, "sensor_spectra")
        self.line = complex_values(spectra, "line_spectra")
        self.line_frequency = spectra["line_frequency"].values
        response = self.outputs[layout.response]
        self.segments = response.real**2 + response.imag**2
        self.psd = self.segments.mean(axis=0)
        self.peak = find_peak(layout.frequency, self.psd, identification.peak_search_Hz)
        self.peaks: dict[str, PeakFit | None] = dict.fromkeys(LEVELS)
        self.pole: OperationalPole | None = None
        self.shape: DeflectionShape | None = None

    def peak_fits(self, other_modes: Callable) -> dict[str, PeakFit | None]:
        """Return {method: PeakFit of the main peak at its level, or None}.

        other_modes: as in fit_peak.
        """
        spectrum = self.layout.frequency, self.psd, self.layout.kernel
        more = self.peak, other_modes, self.averages, self.segments
        return {
            method: or_none(fit_peak, *spectrum, level, *more) for method, level in LEVELS.items()
        }

    def operational_pole(self, tube_spectra: Callable) -> OperationalPole | None:
        """Return the OperationalPole of the main peak, or None; tube_spectra as there."""
        layout, lscf = self.layout, self.lscf
        band = tuple(lscf.band_Hz)
        search = PoleSearch(layout.frequency, band, layout.window, lscf.max_order)
        spectra = self.outputs, layout.references, search, self.peak
        duration_s = effective_duration(self.averages, layout.kernel)
        return or_none(operational_pole, *spectra, self.averages, duration_s, tube_spectra)

    def main_shape(self, fit: PeakFit | None, fewest_bins: int) -> DeflectionShape | None:
        """Return the shape of the band above 1/25 of the main peak.

        None without a peak, or for a band narrower than fewest_bins.
        """
        if fit is None:
            return None
        edges = np.clip(fit.edges_Hz, self.line_frequency[0], self.line_frequency[-1])
        if edges[1] - edges[0] < fewest_bins * self.layout.spacing_Hz:
            return None
        return deflection_shape(self.line, self.line_frequency, tuple(edges))
