"""The linear tube that all methods compare with.

It is prepared once per process for one model and one set of spectra.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vibroimpact.identify.linear.family import FamilyResponse, LinearFamily, driven_modes
from vibroimpact.identify.linear.modes import support_stiffness
from vibroimpact.identify.linear.poles import first_pole, frequency_of, pole_of
from vibroimpact.identify.spectra.window_leakage import spectral_kernel
from vibroimpact.reduction.modal_model import ModalModel

from .broadband import FamilyMap, family_map
from .equivalent_support import equivalent_support, free_pole
from .estimate import FREQUENCY_ERROR
from .ods import GAIN_ERROR
from .peak import resonance

MAP_STIFFNESSES = 30
SHAPES = 60
# Total damping of the first mode over that without c.
MAP_DAMPING = (0.6, 1.0, 1.6, 2.5, 4.0, 6.5, 10.0)
STABLE_FRACTION = 0.9  # of the negative damping that makes a mode unstable
SMALL_K = 1.0  # N/m, at which derivatives without support are taken


@dataclass(frozen=True)
class Bins:
    """The bins of a case's spectra.

    spacing_Hz: distance of two bins.
    highest: highest index of the sensors' spectra.
    line_first, line_last: first and last index of the shape line's spectra.
    window: name of the analysis window.
    """

    spacing_Hz: float
    highest: int
    line_first: int
    line_last: int
    window: str


@dataclass(frozen=True)
class Sensors:
    """The sensors that the methods use.

    names: of the channels of the spectra.
    response, broadband: indices of the channels of these methods.
    references: indices of the reference channels.
    """

    names: tuple
    response: int
    broadband: int
    references: tuple


def compared_bins(
    frequency: np.ndarray, bins: Bins, force_band_Hz: Sequence[float], band_Hz: Sequence[float]
) -> slice:
    """Return the bins (of frequency in Hz) of a band that lie inside the band of the force."""
    margin = 2.0 * bins.spacing_Hz  # the window smears the edges of the force's band
    low = max(band_Hz[0], force_band_Hz[0] + margin)
    high = min(band_Hz[1], force_band_Hz[1] - margin)
    return slice(
        int(np.searchsorted(frequency, low - 1e-9)), int(np.searchsorted(frequency, high + 1e-9))
    )


def seen_band_Hz(force_band_Hz: Sequence[float], bins: Bins) -> tuple[float, float]:
    """Return the part of the band of the force in which the spectra have bins, Hz."""
    low, high = force_band_Hz
    return max(low, bins.spacing_Hz), min(high, bins.highest * bins.spacing_Hz)


def on_grid(force_psd: np.ndarray | None, bins: Bins, grid: np.ndarray) -> np.ndarray | None:
    """Return (point,) a relative PSD (frequency,) of the bins on a finer grid (point,) in Hz."""
    if force_psd is None:
        return None
    return np.interp(grid, np.arange(force_psd.size) * bins.spacing_Hz, force_psd)


class ReferenceTube:
    """Responses of the linear tube with any (k, c) at the sensors and along the shape line."""

    def __init__(
        self,
        model: ModalModel,
        bins: Bins,
        sensors: Sensors,
        force_band_Hz: Sequence[float],
        broadband_Hz: Sequence[float],
        stiffness_range: Sequence[float],
        force_psd: np.ndarray | None = None,
    ) -> None:
        """Prepare the family of responses.

        force_band_Hz: the band of the force.
        broadband_Hz: band of the broadband method; it is cut to that of the force.
        stiffness_range: N/m.
        force_psd: (frequency,) relative PSD of the force on the bins; None for a white one.
        """
        self.model, self.bins, self.sensors = model, bins, sensors
        self.stiffness_range = (stiffness_range[0], stiffness_range[1])
        self.modes = driven_modes(model)
        self.kernel = spectral_kernel(bins.window, 1.0 / bins.spacing_Hz)
        self.force_band_Hz = force_band_Hz
        fine = self.kernel.oversampling
        points = bins.highest * fine + self.kernel.half_width + 1
        grid = np.arange(points) * (bins.spacing_Hz / fine)
        self.family = LinearFamily(self.modes, grid, on_grid(force_psd, bins, grid))
        self.frequency = np.arange(bins.highest + 1) * bins.spacing_Hz
        columns = [model.sensor_names.index(name) for name in sensors.names]
        self.at_sensors = self.family.response(model.sensor_shapes[:, columns])
        self.at_line = self.family.response(
            model.line_shapes, slice(bins.line_first * fine, bins.line_last * fine + 1, fine)
        )
        self.excited = (self.frequency >= force_band_Hz[0]) & (self.frequency <= force_band_Hz[1])
        self.broadband = compared_bins(self.frequency, bins, force_band_Hz, broadband_Hz)

    @property
    def seen_band_Hz(self) -> tuple[float, float]:
        """Return the band in Hz in which the force has power and the spectra have bins."""
        return seen_band_Hz(self.force_band_Hz, self.bins)

    @cached_property
    def at_broadband(self) -> FamilyResponse:
        """Return the FamilyResponse of the broadband sensor on the fine grid of its band."""
        index = self.kernel.fine_index(self.frequency[self.broadband])
        response, own = self.at_sensors, slice(self.sensors.broadband, self.sensors.broadband + 1)
        return type(response)(
            response.frequency[index],
            response.free[:, own, index],
            response.residue[:, own, index],
            response.compliance[index],
        )

    @cached_property
    def broadband_map(self) -> FamilyMap:
        """Return the FamilyMap of the broadband sensor."""
        k = np.geomspace(self.stiffness_range[0], self.stiffness_range[1], MAP_STIFFNESSES)
        c = np.array([[self._map_damping(each, factor) for factor in MAP_DAMPING] for each in k])
        return family_map(self.at_broadband, self.kernel, k, c)

    def _map_damping(self, k: float, factor: float) -> float:
        """Return the c in N s/m that multiplies the first damping ratio by a factor, if stable."""
        c = self.damping_for(k, factor * self.first_damping_ratio(k))
        return max(c, self.lowest_stable_damping(k))

    @cached_property
    def _first_modes(self) -> tuple[np.ndarray, ...]:
        """Return a table over k of the first mode at c = 0, each column (k,).

        ln k; frequency in Hz; damping ratio; its derivative by c in 1/(N s/m); and the c in N s/m
        at which a mode in the range of the spectra loses its damping.
        """
        k = np.geomspace(SMALL_K, self.stiffness_range[1] * 10.0, 60)
        columns = []
        for stiffness in k:
            omega, shapes = self._block_modes(stiffness)
            moved = np.sum((self.modes.contact.T @ shapes) ** 2, axis=0)
            damped = self.modes.damping @ shapes**2
            observed = omega < 2.0 * np.pi * self.frequency[-1]
            observed[0] = True  # a stiff support lifts even the first mode above the spectra
            least = -np.min(damped[observed] / moved[observed])
            frequency, ratio = 0.5 * omega[0] / np.pi, 0.5 * damped[0] / omega[0]
            columns.append((frequency, ratio, 0.5 * moved[0] / omega[0], least))
        return np.log(k), *np.array(columns).T

    def lowest_stable_damping(self, k: float) -> float:
        """Return the negative c in N s/m at which a mode in the spectra has almost no damping."""
        table = self._first_modes
        return STABLE_FRACTION * float(np.interp(np.log(max(k, SMALL_K)), table[0], table[4]))

    def first_frequency(self, k: float) -> float:
        """Return the first mode's frequency in Hz at c = 0."""
        return float(np.interp(np.log(max(k, SMALL_K)), self._first_modes[0], self._first_modes[1]))

    def frequency_slope(self, k: float) -> float:
        """Return d ln(first frequency) / d ln(k) at c = 0.

        It is half the share of the supports in the first mode's elastic energy.
        """
        k = max(k, SMALL_K)
        return self.damping_ratio_slope(k) * k / (2.0 * np.pi * self.first_frequency(k))

    def _block_modes(self, k: float) -> tuple[np.ndarray, np.ndarray]:
        """Return (omega (value,) rad/s ascending, vectors (mode, value)) of the driven block.

        c = 0.
        """
        block = self.modes.block
        contact = self.modes.contact[block]
        stiffness = support_stiffness(self.modes.omega[block], contact, k)
        values, vectors = np.linalg.eigh(stiffness)
        shapes = np.zeros((block.size, values.size))
        shapes[block] = vectors
        return np.sqrt(values), shapes

    def first_damping_ratio(self, k: float) -> float:
        """Return the first mode's damping ratio at c = 0."""
        table = self._first_modes
        return float(np.interp(np.log(max(k, SMALL_K)), table[0], table[2]))

    def damping_ratio_slope(self, k: float) -> float:
        """Return d(first damping ratio)/dc in 1/(N s/m) at c = 0."""
        table = self._first_modes
        return float(np.exp(np.interp(np.log(max(k, SMALL_K)), table[0], np.log(table[3]))))

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
        own = slice(self.sensors.response, self.sensors.response + 1)

        def factor(fine_index):
            if not np.isfinite(support.k):
                return np.ones(fine_index.size)
            psd = self.at_sensors.psd(support.k, support.c, fine_index, own)[0]
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
        fine = self.kernel.oversampling
        every_bin = slice(0, self.bins.highest * fine + 1, fine)
        response = self.at_sensors.frf(support.k, c, every_bin) * self.excited
        seen = response[:, None, list(self.sensors.references), :].conj()
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
        k = np.geomspace(self.stiffness_range[0], self.stiffness_range[1], SHAPES)
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
