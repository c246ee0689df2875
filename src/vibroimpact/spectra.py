"""Averaged spectra of records: PSD with mean, minimum and maximum over segments, and segment spectra.

Source: Thénint, Balmes, Corus (ISMA 2012), eq. (3), corrected: the printed formula lacks the division by the window's power and the
segment's length.
Everything here is one-sided, in unit²/Hz; the time axis or the frequency axis is last.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr


@dataclass(frozen=True)
class SegmentSpectra:
    """Windowed Fourier transforms of the segments of one record, scaled so that the mean of |values|² is the PSD.

    frequency: (frequency,) Hz; values: (channel, segment, frequency) complex, unit/sqrt(Hz).
    """

    frequency: np.ndarray
    values: np.ndarray


def window_values(window, length):
    """Return the samples (length,) of a named window, in its periodic form as spectral estimation needs it."""
    if window == "boxcar":
        return np.ones(length)
    if window == "hann":  # written out: importing scipy.signal costs more than all spectra of a load
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
            f"a segment of {segment_s:g} s does not fit in a record of {samples / sampling_frequency_Hz:g} s: shorten spectra.segment_s"
        )
    if step < 1:
        raise ValueError(f"spectra.overlap = {overlap:g} leaves no step between segments: choose a value below 1")
    return length, step, 1 + (samples - length) // step


def segment_spectra(signals, sampling_frequency_Hz, spectra, highest_Hz=None):
    """Return the SegmentSpectra of signals (channel, time).

    spectra: object with segment_s (s), overlap (fraction of a segment), window (name), the `spectra` part of the configuration.
    highest_Hz: bins above it are dropped. No trend is removed: an excitation without power below some Hz leaves none.
    """
    signals = np.atleast_2d(signals)
    length, step, count = segment_layout(signals.shape[-1], sampling_frequency_Hz, spectra.segment_s, spectra.overlap)
    frequency = np.arange(length // 2 + 1) * (sampling_frequency_Hz / length)
    kept = frequency.size if highest_Hz is None else int(np.searchsorted(frequency, highest_Hz, side="right"))
    window = window_values(spectra.window, length)
    scale = np.full(kept, np.sqrt(2.0 / (sampling_frequency_Hz * np.sum(window**2))))
    scale[0] /= np.sqrt(2.0)  # the zero and the Nyquist bin have no mirror image to be folded in
    if length % 2 == 0 and kept == frequency.size:
        scale[-1] /= np.sqrt(2.0)
    real = np.float32 if signals.dtype == np.float32 else np.float64
    window, scale = window.astype(real), scale.astype(real)
    values = np.empty((signals.shape[0], count, kept), dtype=np.complex64 if real is np.float32 else np.complex128)
    for segment in range(count):
        part = signals[:, segment * step : segment * step + length]
        values[:, segment] = np.fft.rfft(part * window, axis=-1)[:, :kept] * scale
    return SegmentSpectra(frequency[:kept], values)


def psd_statistics(values):
    """Return (mean, minimum, maximum) over segments of |values|² for values (..., segment, frequency), each (..., frequency)."""
    power = values.real**2 + values.imag**2
    return power.mean(axis=-2), power.min(axis=-2), power.max(axis=-2)


def cross_spectra(outputs, references):
    """Return the averaged one-sided cross-spectra (output, reference, frequency), mean over segments of X_output conj(X_reference).

    outputs: (output, segment, frequency), references: (reference, segment, frequency), both as in SegmentSpectra.
    """
    return np.einsum("osf,rsf->orf", outputs, references.conj(), optimize=True) / outputs.shape[-2]


def segment_correlation(spectra, sampling_frequency_Hz, lags):
    """Return rho (lags,): squared correlation of the spectra of two segments 1, 2, ... steps apart, for white noise."""
    length, step, _ = segment_layout(round(spectra.segment_s * sampling_frequency_Hz), sampling_frequency_Hz, spectra.segment_s, spectra.overlap)
    window = window_values(spectra.window, length)
    products = [np.dot(window[: max(length - lag * step, 0)], window[lag * step :]) for lag in range(1, lags + 1)]
    return (np.array(products) / np.dot(window, window)) ** 2


def effective_averages(duration_s, sampling_frequency_Hz, spectra):
    """Return nu, the effective degrees of freedom of one bin of the averaged PSD: nu/2 independent averages.

    nu = 2 M / (1 + 2 sum_k (1 - k/M) rho_k) with M segments; overlapping segments share data, so nu < 2 M.
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
    """Return the frequency (Hz) up to which segment spectra are kept: the bands that the identification reads, and a margin.

    The half spectra of the pole estimator need twice its band, the broadband correlation what its window smears across the end.
    """
    identification = config.identification
    return max(2.0 * identification.lscf.band_Hz[1], 1.2 * identification.broadband.band_Hz[1])


def case_spectra(config, record):
    """Return the spectra Dataset of one case.

    record: Dataset with displacement (sensor, time) m, acceleration (sensor, time) m/s² and line_displacement (line_point, time) m.
    The Dataset holds psd_{displacement,acceleration}_{mean,min,max} (sensor, frequency) in unit²/Hz, the segment spectra of the driven
    direction's sensors, sensor_spectra_{re,im} (driven_sensor, segment, low_frequency) m/sqrt(Hz), and of the shape line,
    line_spectra_{re,im} (line_point, segment, line_frequency) m/sqrt(Hz). A cross-spectrum is the mean over segments of X conj(Y).
    """
    rate = config.record.sampling_frequency_Hz
    names = [str(name) for name in record["sensor"].values]
    data = {}
    for quantity, unit in (("displacement", "m2 Hz-1"), ("acceleration", "m2 s-4 Hz-1")):
        spectra = segment_spectra(record[quantity].values, rate, config.spectra)
        if quantity == "displacement":
            displacement = spectra
        for name, values in zip(("mean", "min", "max"), psd_statistics(spectra.values)):
            long_name = f"{name} over segments of the one-sided power spectral density of {quantity}"
            data[f"psd_{quantity}_{name}"] = (("sensor", "frequency"), values.astype(np.float32), _about(unit, long_name))
    driven = [index for index, name in enumerate(names) if name.endswith("." + driven_axis(config.excitation.direction))]
    low = displacement.frequency <= kept_to_Hz(config)
    _put(data, "sensor_spectra", ("driven_sensor", "segment", "low_frequency"), displacement.values[driven][..., low])
    lowest, highest = config.identification.lscf.band_Hz
    line = segment_spectra(record["line_displacement"].values, rate, config.spectra, highest)
    band = line.frequency >= lowest
    _put(data, "line_spectra", ("line_point", "segment", "line_frequency"), line.values[..., band])
    duration = record.sizes["time"] / rate
    data["effective_averages"] = ((), effective_averages(duration, rate, config.spectra), _about("1", "degrees of freedom of a PSD bin"))
    coords = {
        "sensor": names,
        "driven_sensor": [names[index] for index in driven],
        "frequency": ("frequency", displacement.frequency, _about("Hz", "frequency")),
        "low_frequency": ("low_frequency", displacement.frequency[low], _about("Hz", "frequency")),
        "line_frequency": ("line_frequency", line.frequency[band], _about("Hz", "frequency")),
    }
    attrs = {key: record.attrs[key] for key in record.attrs}
    attrs.update(window=config.spectra.window, segment_s=config.spectra.segment_s, overlap=config.spectra.overlap)
    return xr.Dataset(data, coords, attrs)


def complex_values(dataset, name):
    """Return the complex array stored in dataset as name_re and name_im (netCDF has no complex numbers)."""
    return dataset[name + "_re"].values + 1j * dataset[name + "_im"].values


def _put(data, name, dims, values):
    for suffix, part in (("re", values.real), ("im", values.imag)):
        long_name = f"segment spectra of displacement, {'real' if suffix == 're' else 'imaginary'} part"
        data[f"{name}_{suffix}"] = (dims, part.astype(np.float32), _about("m Hz-1/2", long_name))


def _about(unit, long_name):
    return {"units": unit, "long_name": long_name}
