"""The linear structure whose supports are identified each for itself.

It is prepared once per process for one model and one set of spectra, as `reference_tube` is for
supports that are all alike.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from vibroimpact.identify.linear.poles import frequency_of, pole_of
from vibroimpact.identify.linear.support_groups import reached_supports
from vibroimpact.identify.linear.supported_structure import Observed, SupportedStructure
from vibroimpact.reduction.modal_model import ModalModel

from .peak import resonance
from .reference_tube import STABLE_FRACTION
from .spectra_layout import SpectraLayout


class SupportsTube:
    """Responses of the structure with any supports, at the sensors and along the shape line.

    directions: the SupportDirections that the force reaches, the unknowns.
    """

    def __init__(
        self, model: ModalModel, groups: str | tuple[tuple[str, ...], ...], layout: SpectraLayout
    ) -> None:
        """Prepare the compliances.

        groups: identification.groups.
        """
        self.model, self.layout = model, layout
        self.directions, modes = reached_supports(model, groups)
        self.structure = SupportedStructure(
            model, self.directions, modes, layout.fine_frequency, layout.fine_force_psd
        )
        self._sensor_shapes = layout.sensor_shapes(model)

    @cached_property
    def at_broadband(self) -> tuple[Observed, Observed]:
        """Return the sensors on the fine grid of the broadband comparison, and on its bins."""
        return self._observed(
            self._sensor_shapes, self.layout.frequency[self.layout.broadband_bins]
        )

    @cached_property
    def at_line(self) -> tuple[Observed, Observed]:
        """Return the shape line on the fine grid of its bins, and on these."""
        return self._observed(self.model.line_shapes, self.layout.line_frequency)

    def _observed(self, shapes: np.ndarray, frequency: np.ndarray) -> tuple[Observed, Observed]:
        """Return outputs on the fine grid of some bins (frequency,) in Hz, and on the bins."""
        kernel = self.layout.kernel
        fine = kernel.fine_index(frequency)
        at_bins = self.structure.observed(shapes, fine[kernel.bins])
        return self.structure.observed(shapes, fine), at_bins

    @cached_property
    def at_sensors(self) -> Observed:
        """Return the sensors on the whole fine grid."""
        return self.structure.observed(self._sensor_shapes)

    def lowest_stable_damping(self, k: np.ndarray) -> np.ndarray:
        """Return (direction,) the negative c in N s/m that all modes bear at k (direction,) in N/m.

        Every direction has the same share of a mode's damping.
        """
        structure, count = self.structure, len(self.directions)
        omega, shapes = structure.undamped_modes(k)
        seen = omega < 2.0 * np.pi * self.layout.frequency[-1]
        square = (structure.contact.T @ shapes[:, seen]) ** 2
        moved = np.array([square[structure.owner == each].sum(axis=0) for each in range(count)])
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
        response = self.structure.frf(self.at_sensors, k, c)[:, self.layout.response]
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
        layout = self.layout
        response = self.structure.frf(self.at_sensors, k, c)[layout.fine_bins]
        response = response * layout.excited(layout.frequency)[:, None, None]
        seen = response[:, list(layout.references)].conj()
        cross = np.einsum("foc,frc->orf", response, seen)

        def spectra_near(frequency: float, ratio: float) -> tuple[np.ndarray, complex]:
            return cross, self.structure.pole(k, c, pole_of(frequency, ratio))[0]

        return spectra_near
