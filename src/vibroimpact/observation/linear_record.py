"""A force record and the responses of single modes to it, as Fourier lines of the record."""

from __future__ import annotations

from copy import copy

import numpy as np
from scipy import fft

from .sensed_motion import differentiated

DISCARDED = 0.2  # share at the start of a record that did not start from rest
RATE_PER_BAND = 5.0  # sampling rate of computed responses, in units of the band's upper end


class LinearRecord:
    """A force record, prepared for linear responses to it.

    force (force_channel, sample): N, sampled at rate in Hz. band_Hz: the lines compared. from_rest:
    whether the structure was at rest when the record began. begin: share at the start of the record
    that is not compared; None for 0 from rest and DISCARDED otherwise. base (channel, sample): the
    base's own motion subtracted from the responses, None without; its lines in the band are the
    attribute base (channel, line).
    """

    def __init__(
        self,
        force: np.ndarray,
        rate: float,
        band_Hz: tuple[float, float],
        from_rest: bool = True,
        begin: float | None = None,
        base: np.ndarray | None = None,
    ):
        # The force has nothing above the band, so a fraction of the rate is enough.
        self.every = max(1, int(rate / (RATE_PER_BAND * band_Hz[1])))
        begin = (0.0 if from_rest else DISCARDED) if begin is None else begin
        whole = force.shape[-1] // self.every
        # A length with a large prime factor takes ten times as long to transform.
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

    def of(self, channels: np.ndarray) -> LinearRecord:
        """Return the LinearRecord for the responses of some channels, a mask or indices."""
        if self.base is None:
            return self
        out = copy(self)
        out.base = self.base[channels]
        return out

    def spectra(self, responses: np.ndarray) -> np.ndarray:
        """Return (..., line) complex: the Fourier lines in the band of series (..., sample)."""
        return fft.rfft(responses[..., self.first : self.samples], axis=-1)[
            ..., self.lines
        ] * np.sqrt(2.0 / (self.samples - self.first) ** 2)

    def responses(
        self, omega: np.ndarray, damping: np.ndarray, drive_shapes: np.ndarray, kind: str
    ) -> np.ndarray:
        """Return (mode, line) complex: the lines in the band of the response of each mode.

        omega (mode,): rad/s. damping (mode,): 2 zeta omega in 1/s. drive_shapes (mode,
        force_channel). kind: see sensed_motion.differentiated.
        """
        return self.short_spectra(
            self._driving(drive_shapes, kind) / self._stiffness(omega, damping)
        )

    def changes(
        self, omega: np.ndarray, damping: np.ndarray, drive_shapes: np.ndarray, kind: str
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of `responses` by ln omega and by ln damping ratio, (mode, line)
        each.
        """
        stiffness, damped = self._stiffness(omega, damping), 1j * damping[:, None] * self.omega
        falling = -self._driving(drive_shapes, kind) / stiffness**2
        return self.short_spectra(
            falling * (2.0 * omega[:, None] ** 2 + damped)
        ), self.short_spectra(falling * damped)

    def _driving(self, drive_shapes, kind):
        """Return (mode, line): the modal force, differentiated in time as the kind asks."""
        return drive_shapes @ (differentiated(self.omega, kind) * self.spectrum)

    def _stiffness(self, omega, damping):
        """Return (mode, line): the dynamic stiffness of modes of unit mass."""
        stiffness = np.empty((len(omega), self.omega.size), complex)
        stiffness.real = omega[:, None] ** 2 - self.squared
        stiffness.imag = damping[:, None] * self.omega
        return stiffness

    def short_spectra(self, lines: np.ndarray) -> np.ndarray:
        """Return (..., line): the lines in the band of responses cut to the record.

        lines: spectra of the responses over the whole transform length.
        """
        series = fft.irfft(lines, self.length // self.every, axis=-1)[
            ..., self.first // self.every : self.samples // self.every
        ]
        return fft.rfft(series, axis=-1)[..., self.lines] * np.sqrt(
            2.0 / (self.samples - self.first) ** 2
        )
