"""The linear tube that all methods compare with, prepared once per process for one model and one
set of spectra.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vibroimpact.linear.equivalent_linear import first_pole
from vibroimpact.linear.family import LinearFamily, driven_modes
from vibroimpact.spectra.window_leakage import spectral_kernel

from .broadband import family_map
from .estimate import FREQUENCY_ERROR
from .ods import GAIN_ERROR
from .peak import resonance
from .update import free_pole, frequency_of, pole_of, support_from_pole

MAP_STIFFNESSES = 30
SHAPES = 60
MAP_DAMPING = (
    0.6,
    1.0,
    1.6,
    2.5,
    4.0,
    6.5,
    10.0,
)  # total damping of the first mode over the one without c
STABLE_PART = 0.9  # of the negative damping that makes a mode unstable
SMALL_K = 1.0  # N/m, where derivatives at no support are taken


@dataclass(frozen=True)
class Bins:
    """The bins of a case's spectra: spacing_Hz; highest index of the sensors' spectra; first and
    last of the shape line's; window name.
    """

    spacing_Hz: float
    highest: int
    line_first: int
    line_last: int
    window: str


@dataclass(frozen=True)
class Sensors:
    """Which sensors the methods read: names of the spectra's channels, response and broadband among
    them, reference channels (indices).
    """

    names: tuple
    response: int
    broadband: int
    references: tuple


class ReferenceTube:
    """Responses of the linear tube with any (k, c) at the sensors and along the shape line.

    model: ModalModel; bins: Bins; sensors: Sensors; force_band_Hz: where the force has power;
    broadband_Hz: the band of the broadband method (cut to the force's); stiffness_range: N/m.
    """

    def __init__(self, model, bins, sensors, force_band_Hz, broadband_Hz, stiffness_range):
        self.model, self.bins, self.sensors, self.stiffness_range = (
            model,
            bins,
            sensors,
            tuple(stiffness_range),
        )
        self.modes = driven_modes(model)
        self.kernel = spectral_kernel(bins.window, 1.0 / bins.spacing_Hz)
        self.force_band_Hz = force_band_Hz
        fine = self.kernel.oversampling
        self.family = LinearFamily(
            self.modes,
            np.arange(bins.highest * fine + self.kernel.reach + 1) * (bins.spacing_Hz / fine),
        )
        self.frequency = np.arange(bins.highest + 1) * bins.spacing_Hz
        columns = [model.sensor_names.index(name) for name in sensors.names]
        self.at_sensors = self.family.response(model.sensor_shapes[:, columns])
        self.at_line = self.family.response(
            model.line_shapes, slice(bins.line_first * fine, bins.line_last * fine + 1, fine)
        )
        self.excited = (self.frequency >= force_band_Hz[0]) & (self.frequency <= force_band_Hz[1])
        margin = 2.0 * bins.spacing_Hz  # the window smears the edges of the force's band
        low = max(broadband_Hz[0], force_band_Hz[0] + margin)
        high = min(broadband_Hz[1], force_band_Hz[1] - margin)
        self.broadband = slice(
            int(np.searchsorted(self.frequency, low - 1e-9)),
            int(np.searchsorted(self.frequency, high + 1e-9)),
        )

    @cached_property
    def at_broadband(self):
        """Return the FamilyResponse of the broadband sensor on the fine grid of its band."""
        index = self.kernel.fine_index(self.frequency[self.broadband])
        response, own = self.at_sensors, slice(self.sensors.broadband, self.sensors.broadband + 1)
        return type(response)(
            response.frequency[index],
            response.free[own, index],
            response.residue[own, index],
            response.compliance[index],
        )

    @cached_property
    def broadband_map(self):
        """Return the FamilyMap of the broadband sensor."""
        k = np.geomspace(*self.stiffness_range, MAP_STIFFNESSES)
        c = np.array(
            [
                [
                    max(
                        self.damping_for(stiffness, factor * self.free_ratio(stiffness)),
                        self.least_damping(stiffness),
                    )
                    for factor in MAP_DAMPING
                ]
                for stiffness in k
            ]
        )
        return family_map(self.at_broadband, self.kernel, k, c)

    @cached_property
    def _first_modes(self):
        """Return, each (k,): ln k; frequency in Hz, damping ratio and its derivative to c in 1/(N
        s/m) of the first mode at c = 0; and the c (N s/m) at which a mode in the spectra's range
        loses its damping.
        """
        k = np.geomspace(SMALL_K, self.stiffness_range[1] * 10.0, 60)
        columns = []
        for stiffness in k:
            omega, shapes = self._block_modes(stiffness)
            moved = np.sum((self.modes.contact.T @ shapes) ** 2, axis=0)
            damped = self.modes.damping @ shapes**2
            observed = omega < 2.0 * np.pi * self.frequency[-1]
            least = -np.min(damped[observed] / moved[observed])
            columns.append(
                (
                    0.5 * omega[0] / np.pi,
                    0.5 * damped[0] / omega[0],
                    0.5 * moved[0] / omega[0],
                    least,
                )
            )
        return np.log(k), *np.array(columns).T

    def least_damping(self, k):
        """Return the c (N s/m, negative) at which the first of the modes in the spectra's range has
        almost no damping left.
        """
        table = self._first_modes
        return STABLE_PART * float(np.interp(np.log(max(k, SMALL_K)), table[0], table[4]))

    def first_frequency(self, k):
        """Return the first mode's frequency in Hz at c = 0."""
        return float(np.interp(np.log(max(k, SMALL_K)), *self._first_modes[:2]))

    def frequency_slope(self, k):
        """Return d ln(first frequency) / d ln(k) at c = 0: half the share of the supports in the
        first mode's elastic energy.
        """
        k = max(k, SMALL_K)
        return self.ratio_slope(k) * k / (2.0 * np.pi * self.first_frequency(k))

    def _block_modes(self, k):
        """Return (omega (value,) rad/s, vectors (mode, value)) of the first mode's block at c = 0,
        ascending.
        """
        block = self.modes.block
        contact = self.modes.contact[block]
        values, vectors = np.linalg.eigh(
            np.diag(self.modes.omega[block] ** 2) + k * contact @ contact.T
        )
        shapes = np.zeros((block.size, values.size))
        shapes[block] = vectors
        return np.sqrt(values), shapes

    def free_ratio(self, k):
        """Return the first mode's damping ratio at c = 0."""
        table = self._first_modes
        return float(np.interp(np.log(max(k, SMALL_K)), table[0], table[2]))

    def ratio_slope(self, k):
        """Return d(damping ratio of the first mode)/dc in 1/(N s/m) at c = 0."""
        table = self._first_modes
        return float(np.exp(np.interp(np.log(max(k, SMALL_K)), table[0], np.log(table[3]))))

    def damping_for(self, k, damping_ratio):
        """Return the c (N s/m) that gives the first mode this damping ratio, to first order in
        c.
        """
        return (damping_ratio - self.free_ratio(k)) / self.ratio_slope(k)

    def shape_members(self, damping_ratio, ratio_error):
        """Return the function (ln k, errors = 0) -> (k, c): the member with about that k whose
        first pole has this damping ratio, plus so many times its standard error.

        Exactly: the support that puts the first pole at the frequency of the tube with k and c = 0,
        with that ratio.
        """

        def member(log_k, errors=0.0):
            support = support_from_pole(
                self.modes,
                self.first_frequency(np.exp(log_k)),
                damping_ratio + errors * ratio_error,
            )
            return support.k, support.c

        return member

    def other_modes(self, frequency, damping_ratio):
        """Return the function of the fine index (fine,) that gives N (fine,): the PSD at the
        response sensor of the tube with this first pole, over the curve of that pole alone. Ones
        where no support gives the pole.
        """
        support = support_from_pole(self.modes, frequency, damping_ratio)
        own = slice(self.sensors.response, self.sensors.response + 1)

        def factor(fine_index):
            if not np.isfinite(support.k):
                return np.ones(fine_index.size)
            psd = self.at_sensors.psd(support.k, support.c, fine_index, own)[0]
            ratio = (
                psd
                / resonance(
                    self.family.frequency[fine_index], np.log(frequency), np.log(damping_ratio)
                )[0]
            )
            return ratio / ratio[fine_index.size // 2]

        return factor

    def cross_spectra(self, frequency, damping_ratio):
        """Return (exact cross-spectra (sensor, reference, frequency) of the tube with this first
        pole, the pole in rad/s), or None.

        None when no support gives the pole. Where the pole asks for a c so negative that another
        mode is unstable, c is cut.
        """
        support = support_from_pole(self.modes, frequency, damping_ratio)
        if not np.isfinite(support.k):
            return None
        c, pole = support.c, pole_of(frequency, damping_ratio)
        if c < self.least_damping(support.k):
            c = self.least_damping(support.k)
            pole = first_pole(self.model, support.k, c)
        fine = self.kernel.oversampling
        response = (
            self.at_sensors.frf(support.k, c, slice(0, self.bins.highest * fine + 1, fine))
            * self.excited
        )
        return response[:, None, :] * response[None, list(self.sensors.references), :].conj(), pole

    @cached_property
    def pole_error_free(self):
        """Return the standard error of k (N/m) near k = 0 that an error of the model's first
        frequency causes.
        """
        frequency, ratio = frequency_of(free_pole(self.modes))
        return (
            abs(support_from_pole(self.modes, frequency, ratio).jacobian[0, 0])
            * FREQUENCY_ERROR
            * frequency
        )

    @cached_property
    def mode_shapes(self):
        """Return (k (k,) N/m over the stiffness range, first mode's shapes (k, line_point) of unit
        length at c = 0).
        """
        k = np.geomspace(*self.stiffness_range, SHAPES)
        shapes = np.array(
            [
                self.model.line_shapes[self.modes.indices].T @ self._block_modes(stiffness)[1][:, 0]
                for stiffness in k
            ]
        )
        return k, shapes / np.linalg.norm(shapes, axis=1, keepdims=True)

    @cached_property
    def shape_error_free(self):
        """Return the standard error of k (N/m) near k = 0 that errors of the sensors' gains cause
        in the shape.
        """
        step = 0.1 * self.pole_error_free
        shapes = [
            self.model.line_shapes[self.modes.indices].T @ self._block_modes(k)[1][:, 0]
            for k in (0.0, step)
        ]
        free, moved = (shape / np.linalg.norm(shape) for shape in shapes)
        slope = (moved * np.sign(moved @ free) - free) / step
        slope -= free * (free @ slope)
        return GAIN_ERROR * float(np.sqrt(np.sum((slope * free) ** 2)) / (slope @ slope))
