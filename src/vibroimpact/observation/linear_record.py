"""A force record and the responses of single modes to it, as Fourier lines of what was recorded."""

from copy import copy

import numpy as np
from scipy import fft

from .sensed_motion import differentiated

DISCARDED = 0.2  # of a record that did not start from rest
RATE_PER_BAND = 5.0  # rate at which responses are formed, in units of the band's upper end


class LinearRecord:
    """A force record, ready for linear responses to it.

    force (force_channel, sample) N at rate Hz; band_Hz: lines that are compared; from_rest: False
    for a record that was under way; begin: share of the record that is not compared, None for that
    of the start alone. base (channel, sample): the base's own motion that was taken out of the
    responses, None for none; as lines in the band it is kept in base (channel, line).
    """

    def __init__(self, force, rate, band_Hz, from_rest=True, begin=None, base=None):
        # responses are needed at a fraction of the rate only: the force holds nothing above the
        # band
        self.every = max(1, int(rate / (RATE_PER_BAND * band_Hz[1])))
        begin = (0.0 if from_rest else DISCARDED) if begin is None else begin
        whole = force.shape[-1] // self.every
        # as much as is quick to transform: a length with a large prime factor takes ten times as
        # long
        compared = fft.prev_fast_len(whole - int(begin * whole), real=True)
        first = whole - compared if begin else 0
        samples, self.first = self.every * (first + compared), self.every * first
        self.rate, self.samples = rate, samples
        self.length = self.every * fft.next_fast_len(2 * samples // self.every, real=True)
        kept = self.length // self.every // 2 + 1
        self.omega = 2.0 * np.pi * fft.rfftfreq(self.length, 1.0 / rate)[:kept]
        self.spectrum = fft.rfft(force[..., :samples], self.length)[..., :kept]
        self.squared = self.omega**2
        frequency = fft.rfftfreq(samples - self.first, 1.0 / rate)
        self.lines = np.flatnonzero((frequency >= band_Hz[0]) & (frequency <= band_Hz[1]))
        self.frequency = frequency[self.lines]
        self.base = None if base is None else self.spectra(base)

    def of(self, channels):
        """Return the LinearRecord for the responses of some channels alone, a mask or indices."""
        if self.base is None:
            return self
        out = copy(self)
        out.base = self.base[channels]
        return out

    def spectra(self, responses):
        """Return (..., line) complex: the Fourier lines in the band of series (..., sample)."""
        return fft.rfft(responses[..., self.first : self.samples], axis=-1)[
            ..., self.lines
        ] * np.sqrt(2.0 / (self.samples - self.first) ** 2)

    def responses(self, omega, damping, drive_shapes, kind):
        """Return (mode, line) complex for modes of omega rad/s, damping = 2 zeta omega 1/s and
        drive_shapes (mode, force_channel).

        kind: of motion: displacement, velocity or acceleration.
        """
        return self.short_spectra(
            self._driving(drive_shapes, kind) / self._stiffness(omega, damping)
        )

    def changes(self, omega, damping, drive_shapes, kind):
        """Return (by ln omega, by ln damping ratio) of what responses returns, each (mode,
        line).
        """
        stiffness, damped = self._stiffness(omega, damping), 1j * damping[:, None] * self.omega
        falling = -self._driving(drive_shapes, kind) / stiffness**2
        return self.short_spectra(
            falling * (2.0 * omega[:, None] ** 2 + damped)
        ), self.short_spectra(falling * damped)

    def _driving(self, drive_shapes, kind):
        """Return (mode, line): the modal force, differentiated as a kind of motion is."""
        return drive_shapes @ (differentiated(self.omega, kind) * self.spectrum)

    def _stiffness(self, omega, damping):
        """Return (mode, line) dynamic stiffness of modes."""
        stiffness = np.empty((len(omega), self.omega.size), complex)
        stiffness.real = omega[:, None] ** 2 - self.squared
        stiffness.imag = damping[:, None] * self.omega
        return stiffness

    def short_spectra(self, lines):
        """Return (..., line): the lines in the band of responses given by their spectra over the
        whole length, cut to the record.
        """
        series = fft.irfft(lines, self.length // self.every, axis=-1)[
            ..., self.first // self.every : self.samples // self.every
        ]
        return fft.rfft(series, axis=-1)[..., self.lines] * np.sqrt(
            2.0 / (self.samples - self.first) ** 2
        )
