"""The linear structure whose supports are identified each for itself.

It is prepared once per process for one model and one set of spectra, as `reference_tube` is for
supports that are all alike.
"""

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from vibroimpact.identify.linear.poles import frequency_of, pole_of
from vibroimpact.identify.linear.support_groups import SupportDirection
from vibroimpact.identify.linear.supported_structure import Observed, SupportedStructure
from vibroimpact.identify.spectra.window_leakage import spectral_kernel
from vibroimpact.reduction.modal_model import ModalModel

from .peak import resonance
from .reference_tube import STABLE_FRACTION, Bins, Sensors, compared_bins, on_grid, seen_band_Hz


class SupportsTube:
    """Responses of the structure with any supports, at the sensors and along the shape line.

    directions: the SupportDirections that the force reaches, the unknowns.
    """

    def __init__(
        self,
        model: ModalModel,
        reached: tuple[Sequence[SupportDirection], np.ndarray],
        bins: Bins,
        sensors: Sensors,
        bands_Hz: tuple[Sequence[float], Sequence[float]],
        stiffness_range: Sequence[float],
        force_psd: np.ndarray | None = None,
    ) -> None:
        """Prepare the compliances.

        reached: (directions, mode indices) that the force reaches.
        bands_Hz: bands of the force and of the broadband comparison.
        stiffness_range: N/m.
        force_psd: (frequency,) relative PSD of the force on the bins; None for a white one.
        """
        self.model, self.bins, self.sensors = model, bins, sensors
        self.directions, modes = reached
        self.stiffness_range = (stiffness_range[0], stiffness_range[1])
        self.kernel = spectral_kernel(bins.window, 1.0 / bins.spacing_Hz)
        self.frequency = np.arange(bins.highest + 1) * bins.spacing_Hz
        force_band_Hz, broadband_Hz = bands_Hz
        self.broadband = compared_bins(self.frequency, bins, force_band_Hz, broadband_Hz)
        fine = self.kernel.oversampling
        points = bins.highest * fine + self.kernel.half_width + 1
        grid = np.arange(points) * (bins.spacing_Hz / fine)
        psd = on_grid(force_psd, bins, grid)
        self.structure = SupportedStructure(model, self.directions, modes, grid, psd)
        self.excited = (self.frequency >= force_band_Hz[0]) & (self.frequency <= force_band_Hz[1])
        self.force_band_Hz = force_band_Hz
        self._columns = [model.sensor_names.index(name) for name in sensors.names]

    @cached_property
    def at_broadband(self) -> Observed:
        """Return the sensors on the fine grid of the broadband comparison."""
        index = self.kernel.fine_index(self.frequency[self.broadband])
        return self.structure.observed(self.model.sensor_shapes[:, self._columns], index)

    @cached_property
    def at_broadband_bins(self) -> Observed:
        """Return the sensors on the bins of the broadband comparison."""
        index = np.arange(self.frequency.size)[self.broadband] * self.kernel.oversampling
        return self.structure.observed(self.model.sensor_shapes[:, self._columns], index)

    @cached_property
    def at_sensors(self) -> Observed:
        """Return the sensors on the whole fine grid."""
        return self.structure.observed(self.model.sensor_shapes[:, self._columns])

    @cached_property
    def at_line(self) -> Observed:
        """Return the shape line on the fine grid of its bins."""
        index = self.kernel.fine_index(self.line_frequency)
        return self.structure.observed(self.model.line_shapes, index)

    @cached_property
    def at_line_bins(self) -> Observed:
        """Return the shape line on its bins."""
        index = np.arange(self.bins.line_first, self.bins.line_last + 1)
        return self.structure.observed(self.model.line_shapes, index * self.kernel.oversampling)

    @property
    def line_frequency(self) -> np.ndarray:
        """Return (frequency,) Hz, the bins of the shape line."""
        return np.arange(self.bins.line_first, self.bins.line_last + 1) * self.bins.spacing_Hz

    @property
    def seen_band_Hz(self) -> tuple[float, float]:
        """Return the band in Hz in which the force has power and the spectra have bins."""
        return seen_band_Hz(self.force_band_Hz, self.bins)

    def force_psd(self, frequency: np.ndarray) -> np.ndarray:
        """Return (frequency,) 1 if the force has power, else 0."""
        inside = (frequency >= self.force_band_Hz[0]) & (frequency <= self.force_band_Hz[1])
        return inside.astype(float)

    def lowest_stable_damping(self, k: np.ndarray) -> np.ndarray:
        """Return (direction,) the negative c in N s/m that all modes bear at k (direction,) in N/m.

        Every direction has the same share of a mode's damping.
        """
        structure, count = self.structure, len(self.directions)
        omega, shapes = structure.undamped_modes(k)
        seen = omega < 2.0 * np.pi * self.frequency[-1]
        moved = structure.support_motion(shapes[:, seen])
        damped = structure.damping @ shapes[:, seen] ** 2
        bearable = damped / np.maximum(moved * count, np.finfo(float).tiny)
        return -STABLE_FRACTION * bearable.min(axis=1)

    def other_modes(
        self, k: np.ndarray, c: np.ndarray
    ) -> Callable[[float, float], Callable[[np.ndarray], np.ndarray]]:
        """Return the function of (frequency, damping ratio) that fit_peak divides a peak by.

        The function that it returns gives, on fine indices (fine,), the PSD at the response sensor
        of the structure with supports k, c (direction,) over the curve of its own pole near there.
        """
        response = self.structure.frf(self.at_sensors, k, c)[:, self.sensors.response]
        psd = np.sum(response.real**2 + response.imag**2, axis=-1)
        grid = self.structure.frequency

        def factor_near(frequency: float, ratio: float) -> Callable[[np.ndarray], np.ndarray]:
            pole, _ = self.structure.pole(k, c, pole_of(frequency, ratio))
            own, own_ratio = frequency_of(pole)
            if not 0.0 < own_ratio < 1.0:
                return lambda fine_index: np.ones(fine_index.size)
            curve = psd / resonance(grid, np.log(own), np.log(own_ratio))[0]

            def factor(fine_index: np.ndarray) -> np.ndarray:
                # The modes move with the pole: the factor of the same relative frequency.
                place = grid[fine_index] * (own / frequency)
                ratio_there = np.interp(place, grid, curve)
                return ratio_there / ratio_there[fine_index.size // 2]

            return factor

        return factor_near

    def cross_spectra(
        self, k: np.ndarray, c: np.ndarray
    ) -> Callable[[float, float], tuple[np.ndarray, complex]]:
        """Return the function of (frequency, damping ratio) that operational_pole needs.

        It gives the exact cross-spectra (sensor, reference, frequency) of the structure with
        supports k, c (direction,), and its own pole near there in rad/s.
        """
        fine = self.kernel.oversampling
        bins = slice(0, self.bins.highest * fine + 1, fine)
        response = self.structure.frf(self.at_sensors, k, c)[bins]
        response = response * self.excited[:, None, None]
        seen = response[:, list(self.sensors.references)].conj()
        cross = np.einsum("foc,frc->orf", response, seen)

        def spectra_near(frequency: float, ratio: float) -> tuple[np.ndarray, complex]:
            return cross, self.structure.pole(k, c, pole_of(frequency, ratio))[0]

        return spectra_near
