"""Averaged spectra of records: PSD with mean, minimum and maximum over segments, segment spectra.

Spectra are one-sided, in unit²/Hz; the time or frequency axis is last. Source: Thénint, Balmes and
Corus (ISMA 2012), eq. (3), corrected: the printed formula lacks the division by the power of the
window and by the length of the segment.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.fft import rfft  # three times as fast as numpy for many channels of float32

from vibroimpact.config.stage_settings import ConfigPart

LEAST_PART = 0.1  # of an excitation's largest component, for an axis to count as driven


@dataclass(frozen=True)
class SegmentSpectra:
    """Windowed Fourier transforms of the segments of a record; the mean of |values|² is the PSD.

    frequency: (frequency,) Hz.
    values: (channel, segment, frequency) complex, unit/sqrt(Hz).
    """

    frequency: np.ndarray
    values: np.ndarray


def window_values(window: str, length: int) -> np.ndarray:
    """Return the samples (length,) of a window, hann or boxcar, in its periodic form."""
    if window == "boxcar":
        return np.ones(length)
    # Written out: importing scipy.signal takes longer than all spectra of a load.
    if window == "hann":
        return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)
    raise ValueError(f"unknown window '{window}': choose hann or boxcar")


def segment_layout(
    samples: int, sampling_frequency_Hz: float, segment_s: float, overlap: float
) -> tuple[int, int, int]:
    """Return (segment length, step between segments, number of segments), in samples and counts.

    Raises ValueError when not even one segment fits.
    """
    length = int(round(segment_s * sampling_frequency_Hz))
    step = length - int(round(overlap * length))
    if length < 2 or length > samples:
        raise ValueError(
            f"a segment of {segment_s:g} s does not fit in a record of"
            f" {samples / sampling_frequency_Hz:g} s: shorten spectra.segment_s"
        )
    if step < 1:
        raise ValueError(
            f"spectra.overlap = {overlap:g} leaves no step between segments: choose a value below 1"
        )
    return length, step, 1 + (samples - length) // step


def segment_spectra(
    signals: np.ndarray,
    sampling_frequency_Hz: float,
    spectra: ConfigPart,
    highest_Hz: float | None = None,
) -> SegmentSpectra:
    """Return the SegmentSpectra of signals (channel, time).

    No trend is removed: an excitation without power at the lowest frequencies leaves none.

    spectra: section of the configuration with segment_s (s), overlap (fraction) and window (name).
    highest_Hz: bins above it are dropped.
    """
    signals = np.atleast_2d(signals)
    transform = SegmentTransform(sampling_frequency_Hz, spectra, signals.dtype, highest_Hz)
    length, step, count = segment_layout(
        signals.shape[-1], sampling_frequency_Hz, spectra.segment_s, spectra.overlap
    )
    values = np.empty((signals.shape[0], count, transform.frequency.size), dtype=transform.dtype)
    for segment in range(count):
        values[:, segment] = transform(signals[:, segment * step : segment * step + length])
    return SegmentSpectra(transform.frequency, values)


class SegmentTransform:
    """The windowed Fourier transform of one segment, scaled as in SegmentSpectra.

    frequency: (frequency,) Hz.
    dtype: of the values; complex64 for signals of type float32, else complex128.
    """

    def __init__(
        self,
        sampling_frequency_Hz: float,
        spectra: ConfigPart,
        signal_type: np.dtype | type,
        highest_Hz: float | None = None,
    ) -> None:
        length = int(round(spectra.segment_s * sampling_frequency_Hz))
        frequency = np.arange(length // 2 + 1) * (sampling_frequency_Hz / length)
        count = frequency.size
        if highest_Hz is not None:
            count = int(np.searchsorted(frequency, highest_Hz, side="right"))
        window = window_values(spectra.window, length)
        scale = np.full(count, np.sqrt(2.0 / (sampling_frequency_Hz * np.sum(window**2))))
        # The zero and the Nyquist bin have no mirror image to be folded in.
        scale[0] /= np.sqrt(2.0)
        if length % 2 == 0 and count == frequency.size:
            scale[-1] /= np.sqrt(2.0)
        single = signal_type == np.float32
        real = np.float32 if single else np.float64
        self.frequency = frequency[:count]
        self.dtype = np.complex64 if single else np.complex128
        self._window, self._scale = window.astype(real), scale.astype(real)

    def __call__(self, segment: np.ndarray) -> np.ndarray:
        """Return the transforms (channel, frequency) of one segment (channel, time)."""
        return rfft(segment * self._window, axis=-1)[:, : self.frequency.size] * self._scale


def psd_statistics(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (mean, minimum, maximum) of |values|² over segments, each (..., frequency).

    values: (..., segment, frequency).
    """
    power = values.real**2 + values.imag**2
    return power.mean(axis=-2), power.min(axis=-2), power.max(axis=-2)


def effective_averages(
    duration_s: float, sampling_frequency_Hz: float, spectra: ConfigPart
) -> float:
    """Return nu, the effective degrees of freedom of one bin of the averaged PSD.

    A bin is worth nu/2 independent averages: nu = 2 M / (1 + 2 sum_k (1 - k/M) rho_k) with M
    segments and rho_k the squared correlation of the spectra of segments k steps apart, for white
    noise. Overlapping segments share data, so nu < 2 M.
    """
    layout = sampling_frequency_Hz, spectra.segment_s, spectra.overlap
    length, step, count = segment_layout(int(round(duration_s * sampling_frequency_Hz)), *layout)
    if count == 1:
        return 2.0
    lag, window = np.arange(1, count), window_values(spectra.window, length)
    products = [np.dot(window[: max(length - k * step, 0)], window[k * step :]) for k in lag]
    rho = (np.array(products) / np.dot(window, window)) ** 2
    return 2.0 * count / (1.0 + 2.0 * np.sum((1.0 - lag / count) * rho))


def driven_axis(direction: Sequence[float] | np.ndarray) -> str:
    """Return "x", "y" or "z": the global axis closest to the excitation's direction (3,)."""
    return "xyz"[int(np.argmax(np.abs(direction)))]


def driven_axes(direction: Sequence[float] | np.ndarray) -> tuple[str, ...]:
    """Return the global axes that the excitation's direction (3,) has a part along.

    A part counts from LEAST_PART of the largest on.
    """
    parts = np.abs(np.asarray(direction, dtype=float))
    return tuple(
        axis for axis, part in zip("xyz", parts, strict=True) if part >= LEAST_PART * parts.max()
    )


def highest_kept_frequency_Hz(config: ConfigPart) -> float:
    """Return the frequency in Hz up to which the identification needs segment spectra.

    The half spectra of the pole estimator need twice its band. The broadband correlation needs the
    bins that the window smears across the end of its band.
    """
    identification = config.identification
    return max(2.0 * identification.lscf.band_Hz[1], 1.2 * identification.broadband.band_Hz[1])


def complex_values(dataset: xr.Dataset, name: str) -> np.ndarray:
    """Return the complex array stored in a dataset as name_re and name_im."""
    return dataset[name + "_re"].values + 1j * dataset[name + "_im"].values
