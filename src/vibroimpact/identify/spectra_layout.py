"""The layout of a case's spectra: the bins, sensors and bands that the methods use."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.excitation.line_force_spectrum import relative_psd
from vibroimpact.geometry.sections import outer_width
from vibroimpact.identify.spectra.welch import driven_axis
from vibroimpact.identify.spectra.window_leakage import SpectralKernel, spectral_kernel
from vibroimpact.reduction.modal_model import ModalModel


@dataclass(frozen=True)
class SpectraLayout:
    """The bins, sensors and bands of a case's spectra.

    spacing_Hz: distance of two bins.
    highest: highest index of the sensors' spectra.
    line_first, line_last: first and last index of the shape line's spectra.
    window: name of the analysis window.
    sensors: names of the channels of the spectra.
    response, broadband: indices of the channels of these methods.
    references: indices of the reference channels.
    force_band_Hz: the band of the force.
    broadband_Hz: band of the broadband method; it is cut to that of the force.
    stiffness_range: N/m, of the search.
    force_psd: (frequency,) relative PSD of the force on the bins; empty for a white one.
    """

    spacing_Hz: float
    highest: int
    line_first: int
    line_last: int
    window: str
    sensors: tuple[str, ...]
    response: int
    broadband: int
    references: tuple[int, ...]
    force_band_Hz: tuple[float, float]
    broadband_Hz: tuple[float, float]
    stiffness_range: tuple[float, float]
    force_psd: tuple[float, ...] = ()

    @cached_property
    def kernel(self) -> SpectralKernel:
        """Return the SpectralKernel of the analysis window."""
        return spectral_kernel(self.window, 1.0 / self.spacing_Hz)

    @property
    def frequency(self) -> np.ndarray:
        """Return (frequency,) Hz, the bins of the sensors."""
        return np.arange(self.highest + 1) * self.spacing_Hz

    @property
    def line_frequency(self) -> np.ndarray:
        """Return (frequency,) Hz, the bins of the shape line."""
        return np.arange(self.line_first, self.line_last + 1) * self.spacing_Hz

    @property
    def fine_frequency(self) -> np.ndarray:
        """Return (fine,) Hz, the grid on which the kernel smooths the spectra of all bins."""
        fine = self.kernel.oversampling
        points = self.highest * fine + self.kernel.half_width + 1
        return np.arange(points) * (self.spacing_Hz / fine)

    @property
    def fine_bins(self) -> slice:
        """Return the slice of the fine grid that holds the bins of the sensors."""
        fine = self.kernel.oversampling
        return slice(0, self.highest * fine + 1, fine)

    @property
    def fine_force_psd(self) -> np.ndarray | None:
        """Return (fine,) the relative PSD of the force on the fine grid, None for a white one."""
        if not self.force_psd:
            return None
        bins = np.arange(len(self.force_psd)) * self.spacing_Hz
        return np.interp(self.fine_frequency, bins, self.force_psd)

    def excited(self, frequency: np.ndarray) -> np.ndarray:
        """Return (frequency,) bool: whether the force has power at frequencies in Hz."""
        return (frequency >= self.force_band_Hz[0]) & (frequency <= self.force_band_Hz[1])

    @property
    def broadband_bins(self) -> slice:
        """Return the bins of the broadband method that lie inside the band of the force."""
        margin = 2.0 * self.spacing_Hz  # the window smears the edges of the force's band
        low = max(self.broadband_Hz[0], self.force_band_Hz[0] + margin)
        high = min(self.broadband_Hz[1], self.force_band_Hz[1] - margin)
        ends = np.searchsorted(self.frequency, (low - 1e-9, high + 1e-9)).tolist()
        return slice(*ends)

    @property
    def seen_band_Hz(self) -> tuple[float, float]:
        """Return the band in Hz in which the force has power and the spectra have bins."""
        low, high = self.force_band_Hz
        return max(low, self.spacing_Hz), min(high, self.highest * self.spacing_Hz)

    def sensor_shapes(self, model: ModalModel) -> np.ndarray:
        """Return (mode, sensor) the shapes of the sensors."""
        return model.sensor_shapes[:, [model.sensor_names.index(name) for name in self.sensors]]


def spectra_layout(config: ConfigPart, spectra: xr.Dataset) -> SpectraLayout:
    """Return the SpectraLayout of a case.

    config: with structure.section, excitation and identification.
    spectra: dataset of study.case_spectra, see identify_case.
    """
    identification, force = config.identification, config.excitation
    axis = "." + driven_axis(force.direction)
    names = tuple(str(name) for name in spectra["driven_sensor"].values)
    line = spectra["line_frequency"].values
    spacing = 1.0 / float(spectra.attrs["segment_s"])
    in_band = force.kind in ("band_limited", "turbulence")
    return SpectraLayout(
        spacing_Hz=spacing,
        highest=spectra.sizes["low_frequency"] - 1,
        line_first=int(round(line[0] / spacing)),
        line_last=int(round(line[-1] / spacing)),
        window=str(spectra.attrs["window"]),
        sensors=names,
        response=names.index(identification.response_point + axis),
        broadband=names.index(identification.broadband.point + axis),
        references=tuple(names.index(point + axis) for point in identification.lscf.references),
        force_band_Hz=tuple(force.band_Hz) if in_band else (0.0, float("inf")),
        broadband_Hz=tuple(identification.broadband.band_Hz),
        stiffness_range=tuple(identification.stiffness_range_N_per_m),
        force_psd=tuple(_relative_psd(config, spectra)),
    )


def _relative_psd(config: ConfigPart, spectra: xr.Dataset) -> Sequence[float] | np.ndarray:
    """Return (frequency,) the relative PSD of the force: measured, or of turbulence. Else empty."""
    if "force_psd" in spectra:
        return spectra["force_psd"].values
    if config.excitation.kind != "turbulence":
        return ()
    diameter = outer_width(config.structure.section)
    return relative_psd(config.excitation, diameter, spectra["low_frequency"].values)
