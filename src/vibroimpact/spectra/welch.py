"""Averaged spectra of records: PSD with mean, minimum and maximum over segments, and segment
spectra.

Source: Thénint, Balmes, Corus (ISMA 2012), eq. (3), corrected: the printed formula lacks the
division by the window's power and the segment's length. Everything here is one-sided, in unit²/Hz;
the time axis or the frequency axis is last.
"""

from dataclasses import dataclass

import numpy as np
from scipy.fft import rfft  # three times as fast as numpy for many channels of float32


@dataclass(frozen=True)
class SegmentSpectra:
    """Windowed Fourier transforms of the segments of one record, scaled so that the mean of
    |values|² is the PSD.

    frequency: (frequency,) Hz; values: (channel, segment, frequency) complex, unit/sqrt(Hz).
    """

    frequency: np.ndarray
    values: np.ndarray


def window_values(window, length):
    """Return the samples (length,) of a named window, in its periodic form as spectral estimation
    needs it.
    """
    if window == "boxcar":
        return np.ones(length)
    if (
        window == "hann"
    ):  # written out: importing scipy.signal costs more than all spectra of a load
        return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)
    raise ValueError(f"unknown window '{window}': choose hann or boxcar")


def segment_layout(samples, sampling_frequency_Hz, segment_s, overlap):
    """Return (segment length, step between segments, number of segments), all in samples or counts.

    Raises ValueError when not even one segment fits, saying both lengths.
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


def segment_spectra(signals, sampling_frequency_Hz, spectra, highest_Hz=None):
    """Return the SegmentSpectra of signals (channel, time).

    spectra: object with segment_s (s), overlap (fraction of a segment), window (name), the
    `spectra` part of the configuration. highest_Hz: bins above it are dropped. No trend is removed:
    an excitation without power below some Hz leaves none.
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
    """The windowed Fourier transform of one segment, scaled as SegmentSpectra are.

    frequency (frequency,) Hz; dtype of its values: complex64 for signals of type float32, else
    complex128.
    """

    def __init__(self, sampling_frequency_Hz, spectra, signal_type, highest_Hz=None):
        length = int(round(spectra.segment_s * sampling_frequency_Hz))
        frequency = np.arange(length // 2 + 1) * (sampling_frequency_Hz / length)
        kept = (
            frequency.size
            if highest_Hz is None
            else int(np.searchsorted(frequency, highest_Hz, side="right"))
        )
        window = window_values(spectra.window, length)
        scale = np.full(kept, np.sqrt(2.0 / (sampling_frequency_Hz * np.sum(window**2))))
        scale[0] /= np.sqrt(
            2.0
        )  # the zero and the Nyquist bin have no mirror image to be folded in
        if length % 2 == 0 and kept == frequency.size:
            scale[-1] /= np.sqrt(2.0)
        real = np.float32 if signal_type == np.float32 else np.float64
        self.frequency, self.dtype = (
            frequency[:kept],
            (np.complex64 if real is np.float32 else np.complex128),
        )
        self._window, self._scale = window.astype(real), scale.astype(real)

    def __call__(self, segment):
        """Return the transforms (channel, frequency) of one segment (channel, time)."""
        return rfft(segment * self._window, axis=-1)[:, : self.frequency.size] * self._scale


def psd_statistics(values):
    """Return (mean, minimum, maximum) over segments of |values|² for values (..., segment,
    frequency), each (..., frequency).
    """
    power = values.real**2 + values.imag**2
    return power.mean(axis=-2), power.min(axis=-2), power.max(axis=-2)


def cross_spectra(outputs, references):
    """Return the averaged one-sided cross-spectra (output, reference, frequency), mean over
    segments of X_output conj(X_reference).

    outputs: (output, segment, frequency), references: (reference, segment, frequency), both as in
    SegmentSpectra.
    """
    return np.einsum("osf,rsf->orf", outputs, references.conj(), optimize=True) / outputs.shape[-2]


def segment_correlation(spectra, sampling_frequency_Hz, lags):
    """Return rho (lags,): squared correlation of the spectra of two segments 1, 2, ... steps apart,
    for white noise.
    """
    length, step, _ = segment_layout(
        round(spectra.segment_s * sampling_frequency_Hz),
        sampling_frequency_Hz,
        spectra.segment_s,
        spectra.overlap,
    )
    window = window_values(spectra.window, length)
    products = [
        np.dot(window[: max(length - lag * step, 0)], window[lag * step :])
        for lag in range(1, lags + 1)
    ]
    return (np.array(products) / np.dot(window, window)) ** 2


def effective_averages(duration_s, sampling_frequency_Hz, spectra):
    """Return nu, the effective degrees of freedom of one bin of the averaged PSD: nu/2 independent
    averages.

    nu = 2 M / (1 + 2 sum_k (1 - k/M) rho_k) with M segments; overlapping segments share data, so nu
    < 2 M.
    """
    samples = int(round(duration_s * sampling_frequency_Hz))
    _, _, count = segment_layout(samples, sampling_frequency_Hz, spectra.segment_s, spectra.overlap)
    if count == 1:
        return 2.0
    lag = np.arange(1, count)
    rho = segment_correlation(spectra, sampling_frequency_Hz, count - 1)
    return 2.0 * count / (1.0 + 2.0 * np.sum((1.0 - lag / count) * rho))


def driven_axis(direction):
    """Return "x", "y" or "z": the global axis closest to the excitation's direction (3,)."""
    return "xyz"[int(np.argmax(np.abs(direction)))]


def kept_to_Hz(config):
    """Return the frequency (Hz) up to which segment spectra are kept: the bands that the
    identification reads, and a margin.

    The half spectra of the pole estimator need twice its band, the broadband correlation what its
    window smears across the end.
    """
    identification = config.identification
    return max(2.0 * identification.lscf.band_Hz[1], 1.2 * identification.broadband.band_Hz[1])


def complex_values(dataset, name):
    """Return the complex array stored in dataset as name_re and name_im (netCDF has no complex
    numbers).
    """
    return dataset[name + "_re"].values + 1j * dataset[name + "_im"].values
