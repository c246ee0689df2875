"""The linear tube that all methods compare with.

It is prepared once per process for one model and one set of spectra.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from vibroimpact.identify.linear.family import FamilyResponse, LinearFamily, driven_modes
from vibroimpact.identify.linear.modes import support_stiffness
from vibroimpact.identify.linear.poles import first_pole, frequency_of, pole_of
from vibroimpact.reduction.modal_model import ModalModel

from .broadband import FamilyMap, family_map
from .equivalent_support import equivalent_support, free_pole
from .estimate import FREQUENCY_ERROR
from .ods import GAIN_ERROR
from .peak import resonance
from .spectra_layout import SpectraLayout

MAP_STIFFNESSES = 30
SHAPES = 60
# Total damping of the first mode over that without c.
MAP_DAMPING = (0.6, 1.0, 1.6, 2.5, 4.0, 6.5, 10.0)
STABLE_FRACTION = 0.9  # of the negative damping that makes a mode unstable
SMALL_K = 1.0  # N/m, at which derivatives without support are taken


class ReferenceTube:
    """Responses of the linear tube with any (k, c) at the sensors and along the shape line."""

    def __init__(self, model: ModalModel, layout: SpectraLayout) -> None:
        """Prepare the family of responses."""
        self.model, self.layout = model, layout
        self.modes = driven_modes(model)
        self.family = LinearFamily(self.modes, layout.fine_frequency, layout.fine_force_psd)
        self.at_sensors = self.family.response(layout.sensor_shapes(model))
        fine = layout.kernel.oversampling
        line = slice(layout.line_first * fine, layout.line_last * fine + 1, fine)
        self.at_line = self.family.response(model.line_shapes, line)

    @cached_property
    def at_broadband(self) -> FamilyResponse:
        """Return the FamilyResponse of the broadband sensor on the fine grid of its band."""
        layout = self.layout
        index = layout.kernel.fine_index(layout.frequency[layout.broadband_bins])
        return self.at_sensors.of(index, slice(layout.broadband, layout.broadband + 1))

    @cached_property
    def broadband_map(self) -> FamilyMap:
        """Return the FamilyMap of the broadband sensor."""

        def damping(k: float, factor: float) -> float:
            wanted = self.damping_for(k, factor * self.first_damping_ratio(k))
            return max(wanted, self.lowest_stable_damping(k))

        k = np.geomspace(*self.layout.stiffness_range, MAP_STIFFNESSES)
        c = np.array([[damping(each, factor) for factor in MAP_DAMPING] for each in k])
        return family_map(self.at_broadband, self.layout.kernel, k, c)

    @cached_property
    def _first_modes(self) -> tuple[np.ndarray, ...]:
        """Return a table over k of the first mode at c = 0, each column (k,).

        ln k; frequency in Hz; damping ratio; its derivative by c in 1/(N s/m); and the c in N s/m
        at which a mode in the range of the spectra loses its damping.
        """
        k = np.geomspace(SMALL_K, self.layout.stiffness_range[1] * 10.0, 60)
        columns = []
        for stiffness in k:
            omega, shapes = self._block_modes(stiffness)
            moved = np.sum((self.modes.contact.T @ shapes) ** 2, axis=0)
            damped = self.modes.damping @ shapes**2
            observed = omega < 2.0 * np.pi * self.layout.frequency[-1]
            observed[0] = True  # a stiff support lifts even the first mode above the spectra
            least = -np.min(damped[observed] / moved[observed])
            frequency, ratio = 0.5 * omega[0] / np.pi, 0.5 * damped[0] / omega[0]
            columns.append((frequency, ratio, 0.5 * moved[0] / omega[0], least))
        return np.log(k), *np.array(columns).T

    def lowest_stable_damping(self, k: float) -> float:
        """Return the negative c in N s/m at which a mode in the spectra has almost no damping."""
        return STABLE_FRACTION * self._interpolated(k, self._first_modes[4])

    def _interpolated(self, k: float, column: np.ndarray) -> float:
        """Return the value at k in N/m of a column of the table."""
        return float(np.interp(np.log(max(k, SMALL_K)), self._first_modes[0], column))

    def first_frequency(self, k: float) -> float:
        """Return the first mode's frequency in Hz at c = 0."""
        return self._interpolated(k, self._first_modes[1])

    def frequency_slope(self, k: float) -> float:
        """Return d ln(first frequency) / d ln(k) at c = 0.

        It is half the share of the supports in the first mode's elastic energy.
        """
        k = max(k, SMALL_K)
        return self.damping_ratio_slope(k) * k / (2.0 * np.pi * self.first_frequency(k))

    def _block_modes(self, k: float) -> tuple[np.ndarray, np.ndarray]:
        """Return (omega (value,) rad/s ascending, vectors (mode, value)) of the driven block."""
        block = self.modes.block
        contact = self.modes.contact[block]
        stiffness = support_stiffness(self.modes.omega[block], contact, k)
        values, vectors = np.linalg.eigh(stiffness)
        shapes = np.zeros((block.size, values.size))
        shapes[block] = vectors
        return np.sqrt(values), shapes

    def first_damping_ratio(self, k: float) -> float:
        """Return the first mode's damping ratio at c = 0."""
        return self._interpolated(k, self._first_modes[2])

    def damping_ratio_slope(self, k: float) -> float:
        """Return d(first damping ratio)/dc in 1/(N s/m) at c = 0."""
        return float(np.exp(self._interpolated(k, np.log(self._first_modes[3]))))

    def damping_for(self, k: float, damping_ratio: float) -> float:
        """Return the c in N s/m that gives the first mode a damping ratio, to first order in c."""
        return (damping_ratio - self.first_damping_ratio(k)) / self.damping_ratio_slope(k)

    def shape_members(
        self, damping_ratio: float, ratio_error: float
    ) -> Callable[..., tuple[float, float]]:
        """Return the function (ln k, errors = 0) -> (k, c) of members with the peak's damping.

        The first pole has the frequency of the tube with this k and c = 0, and the damping ratio
        plus `errors` times its standard error. The k returned is near the one given.
        """

        def member(log_k, errors=0.0):
            support = equivalent_support(
                self.modes,
                self.first_frequency(np.exp(log_k)),
                damping_ratio + errors * ratio_error,
            )
            return support.k, support.c

        return member

    def other_modes(
        self, frequency: float, damping_ratio: float
    ) -> Callable[[np.ndarray], np.ndarray]:
        """Return the function of the fine index (fine,) that gives N (fine,).

        N is the PSD at the response sensor of the tube with this first pole, over the curve of that
        pole alone. It is 1 if no support gives the pole.
        """
        support = equivalent_support(self.modes, frequency, damping_ratio)
        own = slice(self.layout.response, self.layout.response + 1)

        def factor(fine_index):
            if not np.isfinite(support.k):
                return np.ones(fine_index.size)
            psd = self.at_sensors.of(fine_index, own).psd(support.k, support.c)[0]
            grid = self.family.frequency[fine_index]
            ratio = psd / resonance(grid, np.log(frequency), np.log(damping_ratio))[0]
            return ratio / ratio[fine_index.size // 2]

        return factor

    def cross_spectra(
        self, frequency: float, damping_ratio: float
    ) -> tuple[np.ndarray, complex] | None:
        """Return exact cross-spectra (sensor, reference, frequency) and the first pole in rad/s.

        They belong to the tube with the first pole given. If it needs a c so negative that
        another mode is unstable, c is limited. None when no support gives the pole.
        """
        support = equivalent_support(self.modes, frequency, damping_ratio)
        if not np.isfinite(support.k):
            return None
        c, pole = support.c, pole_of(frequency, damping_ratio)
        if c < self.lowest_stable_damping(support.k):
            c = self.lowest_stable_damping(support.k)
            pole = first_pole(self.model, support.k, c)
        layout = self.layout
        response = self.at_sensors.of(layout.fine_bins).frf(support.k, c)
        response = response * layout.excited(layout.frequency)
        seen = response[:, None, list(layout.references), :].conj()
        return (response[:, :, None, :] * seen).sum(axis=0), pole

    @cached_property
    def pole_error_at_zero(self) -> float:
        """Return the standard error of k in N/m near k = 0 from the model's first frequency."""
        frequency, ratio = frequency_of(free_pole(self.modes))
        slope = abs(equivalent_support(self.modes, frequency, ratio).jacobian[0, 0])
        return slope * FREQUENCY_ERROR * frequency

    @cached_property
    def mode_shapes(self) -> tuple[np.ndarray, np.ndarray]:
        """Return (k (k,) N/m, the first mode's shapes (k, line_point) of unit length at c = 0)."""
        k = np.geomspace(*self.layout.stiffness_range, SHAPES)
        shapes = np.array([self._first_line_shape(stiffness) for stiffness in k])
        return k, shapes / np.linalg.norm(shapes, axis=1, keepdims=True)

    def _first_line_shape(self, k: float) -> np.ndarray:
        """Return (line_point,) the first mode's shape along the line at c = 0."""
        line = self.model.line_shapes[self.modes.indices]
        return line.T @ self._block_modes(k)[1][:, 0]

    @cached_property
    def shape_error_at_zero(self) -> float:
        """Return the standard error of k in N/m near k = 0 from errors of the sensors' gains."""
        step = 0.1 * self.pole_error_at_zero
        shapes = [self._first_line_shape(k) for k in (0.0, step)]
        free, moved = (shape / np.linalg.norm(shape) for shape in shapes)
        slope = (moved * np.sign(moved @ free) - free) / step
        slope -= free * (free @ slope)
        return GAIN_ERROR * float(np.sqrt(np.sum((slope * free) ** 2)) / (slope @ slope))
