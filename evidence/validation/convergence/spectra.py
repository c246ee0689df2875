"""Effect of length, buffer, overlap and window of a record: effective averages and leakage.

Degrees of freedom nu of a bin of an averaged PSD: nu = 2 mean² / variance over records. Welch
(1967), for a PSD that is flat over a bin: nu = 2 M / (1 + 2 sum (1 - k/M) rho_k), rho_k the squared
correlation of two windows k steps apart. At a resonance narrower than a bin neighbouring buffers
stay correlated through the ringing, and the same formula holds with

    rho_k = |integral S(f) |W(f - f0)|² exp(2 pi i f k D) df|² / (integral S(f) |W(f - f0)|² df)²,
    D the step between buffers.

Records are Gaussian here; convergence.impacts has the effect of impacts.
"""

from dataclasses import replace

import numpy as np

from evidence.validation.check import Check
from evidence.validation.prediction.responses import synthesise_records
from vibroimpact.config.schema import Spectra
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.excitation.random_streams import random_generator
from vibroimpact.identify.linear.responses import frf
from vibroimpact.identify.spectra.welch import (
    effective_averages,
    psd_statistics,
    segment_layout,
    segment_spectra,
    window_values,
)

CASE = "convergence: spectra"
# (buffer s, overlap, record s) -> degrees of freedom of a bin, Hann, as published to one decimal
PUBLISHED = {
    (10.0, 0.65, 49.0): 17.8,
    (10.0, 0.5, 49.0): 15.3,
    (5.0, 0.5, 49.0): 34.2,
    (2.0, 0.5, 49.0): 91.0,
    (1.0, 0.5, 49.0): 183.9,
}
PUBLISHED_ROUNDING = 0.05
SETTINGS = tuple(
    (segment, overlap, duration, window)
    for window in ("hann", "boxcar")
    for segment, overlap, duration in (
        *PUBLISHED,
        (10.0, 0.0, 49.0),
        (10.0, 0.65, 24.5),
        (10.0, 0.65, 98.0),
    )
)
NOISE_RATE_HZ, NOISE_RECORDS = 32.0, 1000
NOISE_TOLERANCE = 0.03  # relative: about 3 standard errors
LINEAR_RATE_HZ, LINEAR_BAND_HZ, LINEAR_RECORDS = 256.0, (5.0, 110.0), 1024
LINEAR_SETTINGS = (
    (10.0, 0.65, 49.0, "hann"),
    (10.0, 0.65, 49.0, "boxcar"),
    (5.0, 0.5, 49.0, "hann"),
    (2.0, 0.5, 49.0, "hann"),
    (2.0, 0.5, 49.0, "boxcar"),
    (1.0, 0.5, 49.0, "hann"),
)
LEAKAGE_SEGMENTS_S = (1.0, 2.0, 5.0, 10.0, 20.0, 40.0)
POINT = "bend_45.y"
PEAKS = 3  # of the driven plane: 1.5 % damping, then 0.2 %
FINE_HZ = 1.0e-3  # of the integrals over frequency
REACH_BINS = 60
STANDARD_ERRORS = 4.0
DECIBEL = 10.0 / np.log(10.0)


def averaging(segment_s, overlap, window):
    """Return the section `spectra` of a configuration."""
    return Spectra(segment_s=segment_s, overlap=overlap, window=window)


def degrees_of_freedom(estimates):
    """Return (nu, standard error), each (frequency,): 2 mean² / variance over the records.

    estimates (record, frequency): PSDs.
    """
    count = len(estimates)
    nu = 2.0 * estimates.mean(axis=0) ** 2 / estimates.var(axis=0, ddof=1)
    excess = 12.0 / nu  # excess kurtosis of a chi-squared variable
    return nu, nu * np.sqrt((2.0 + excess) / count)


def scatter_dB(nu):
    """Return the standard deviation of an estimate in dB, to first order: 10/ln 10 sqrt(2/nu)."""
    return DECIBEL * np.sqrt(2.0 / np.asarray(nu, dtype=float))


def estimates_of(records, rate, spectra):
    """Return (frequency (frequency,) Hz, PSD (record, frequency)) of records (record, time)."""
    found = segment_spectra(records, rate, spectra)
    return found.frequency, psd_statistics(found.values)[0]


def noise_rows(study_seed, settings=SETTINGS, records=NOISE_RECORDS):
    """Return one row per setting: effective averages by formula and of white Gaussian noise.

    Row keys: record ("white noise"), segment_s, overlap, duration_s, window, frequency_Hz (NaN: all
    bins), nu_flat, nu_resonance (the same here), nu_measured, standard_error, scatter_dB
    (measured), scatter_flat_dB.
    """
    generator = random_generator(study_seed, 0, "convergence noise")
    rows = []
    for segment, overlap, duration, window in settings:
        spectra = averaging(segment, overlap, window)
        white = generator.standard_normal((records, round(duration * NOISE_RATE_HZ)))
        _, psd = estimates_of(white, NOISE_RATE_HZ, spectra)
        inner = psd[:, 2:-2]  # the ends are one-sided
        inverse = 0.5 * np.mean(inner.var(axis=0, ddof=1) / inner.mean(axis=0) ** 2)
        flat = effective_averages(duration, NOISE_RATE_HZ, spectra)
        error = (
            np.sqrt((2.0 + 12.0 / flat) / records / (inner.shape[1] / 2.0)) / inverse
        )  # about two bins share a window's main lobe
        rows.append(
            _row(
                "white noise",
                (segment, overlap, duration, window),
                np.nan,
                (flat, flat),
                (1.0 / inverse, error),
            )
        )
    return rows


def linear_records(model, study_seed, duration_s=49.0, count=LINEAR_RECORDS):
    """Return (record, time) m at POINT of the tube without contact, cut from one long record.

    The force is noise in LINEAR_BAND_HZ.
    """
    samples = round(duration_s * LINEAR_RATE_HZ)
    force = band_limited_noise(
        random_generator(study_seed, 0, "convergence linear"),
        samples * count,
        LINEAR_RATE_HZ,
        LINEAR_BAND_HZ,
    )
    return synthesise_records(
        without_contact(model), 0.0, 0.0, force, LINEAR_RATE_HZ, _shape(model)
    )[0].reshape(count, samples)


def linear_rows(model, records, settings=LINEAR_SETTINGS):
    """Return one row per setting and peak of the linear tube.

    Row keys: those of `noise_rows`; level_dB (mean over records at the peak's bin in dB of the true
    PSD there), level_error_dB (its standard error), level_expected_dB (true PSD convolved with the
    window).
    """
    rows = []
    for segment, overlap, duration, window in settings:
        spectra = averaging(segment, overlap, window)
        frequency, psd = estimates_of(records, LINEAR_RATE_HZ, spectra)
        for peak in peak_frequencies(model):
            bin_ = int(np.argmin(np.abs(frequency - peak)))
            nu, error = degrees_of_freedom(psd[:, bin_ - 1 : bin_ + 2])
            expected, ringing = at_bin(model, frequency[bin_], duration, spectra)
            flat = effective_averages(duration, LINEAR_RATE_HZ, spectra)
            row = _row(
                "linear tube",
                (segment, overlap, duration, window),
                frequency[bin_],
                (flat, ringing),
                (nu[1], error[1]),
            )
            true = true_psd(model, np.array([peak]))[0] * force_psd()
            mean = psd[:, bin_].mean()
            rows.append(
                row
                | {
                    "level_dB": 10.0 * np.log10(mean / true),
                    "level_error_dB": DECIBEL * psd[:, bin_].std(ddof=1) / mean / np.sqrt(len(psd)),
                    "level_expected_dB": 10.0 * np.log10(expected * force_psd() / true),
                }
            )
    return rows


def at_bin(model, bin_Hz, duration_s, spectra):
    """Return (expected averaged PSD in m²/N², nu) at one bin of the linear tube.

    The force has unit PSD. The formula is that of the module. The expectation covers the whole band
    and its mirror image at negative frequency: through the side lobes of a 2 s boxcar the first
    peak and its image add 0.3 dB to the third one, 90 and 120 Hz away.
    """
    length, step, count = segment_layout(
        round(duration_s * LINEAR_RATE_HZ), LINEAR_RATE_HZ, spectra.segment_s, spectra.overlap
    )
    frequency = np.arange(*LINEAR_BAND_HZ, FINE_HZ)
    bins, image = (frequency - bin_Hz) * spectra.segment_s, (frequency + bin_Hz) * spectra.segment_s
    true = true_psd(model, frequency)
    seen = true * power_kernel(spectra.window, bins, length)
    near = np.abs(bins) < REACH_BINS
    lag = np.arange(1, count)
    turned = (
        np.exp(2j * np.pi * np.outer(lag * step / LINEAR_RATE_HZ, frequency[near])) @ seen[near]
    )
    rho = np.abs(turned / seen[near].sum()) ** 2
    nu = 2.0 * count / (1.0 + 2.0 * np.sum((1.0 - lag / count) * rho))
    return (
        seen + true * power_kernel(spectra.window, image, length)
    ).sum() * FINE_HZ * spectra.segment_s, nu


def power_kernel(window, bins, length):
    """Return |W|² (bin offset,) of a window, of unit area over a period of `length`.

    bins: offsets in bins, any real numbers. length: samples of the window.

    It is the window's discrete Fourier transform in closed form: for sampled records the side lobes
    approach a constant level, not zero.
    """
    amplitude = _boxcar_transform(bins, length)
    if window == "hann":
        amplitude = 0.5 * amplitude - 0.25 * (
            _boxcar_transform(bins - 1.0, length) + _boxcar_transform(bins + 1.0, length)
        )
    return np.abs(amplitude) ** 2 / (length * np.sum(window_values(window, length) ** 2))


def _boxcar_transform(bins, length):
    """Return sum over n < length of exp(-2 pi i bins n / length), for any real `bins`."""
    angle = np.pi * np.asarray(bins, dtype=float) / length
    small = np.abs(np.sin(angle)) < 1.0e-12
    ratio = np.where(
        small,
        length * np.cos(length * angle) * np.cos(angle),
        np.sin(length * angle) / np.where(small, 1.0, np.sin(angle)),
    )
    return ratio * np.exp(-1j * angle * (length - 1))


def leakage_rows(model, segments_s=LEAKAGE_SEGMENTS_S):
    """Return one row per window, buffer and peak: level and apparent damping of the expected PSD.

    Row keys: window, segment_s, peak_Hz, damping_ratio (true), level_dB (of the highest bin over
    the true peak), apparent_damping_ratio (half-power width over 2 f, evaluated at all frequencies,
    not at bins only).
    """
    fine = np.arange(1.0, LINEAR_BAND_HZ[1], FINE_HZ)
    true = {
        peak: _half_width(peak, fine, true_psd(model, fine)) for peak in peak_frequencies(model)
    }
    rows = []
    for window in ("hann", "boxcar"):
        for segment in segments_s:
            curve = expected_psd(model, averaging(segment, 0.5, window))
            for peak, (top, true_ratio) in true.items():
                level, ratio = _half_width(peak, *curve)
                rows.append(
                    {
                        "window": window,
                        "segment_s": segment,
                        "peak_Hz": peak,
                        "damping_ratio": true_ratio,
                        "level_dB": 10.0 * np.log10(level / top),
                        "apparent_damping_ratio": ratio,
                    }
                )
    return rows


def peak_frequencies(model):
    """Return (PEAKS,) Hz of the lowest modes that POINT responds to."""
    seen = np.abs(_shape(model)[:, 0]) > 0.0
    return model.frequencies[seen][:PEAKS]


def true_psd(model, frequency):
    """Return (frequency,) m²/N²: PSD at POINT of the tube without contact, for unit force PSD."""
    return np.abs(frf(without_contact(model), 0.0, 0.0, frequency, _shape(model))[0]) ** 2


def without_contact(model):
    """Return the ModalModel without the motion of its contacts.

    For k = c = 0 the responses are the same, and faster to compute.
    """
    return replace(model, contact_shapes=np.zeros_like(model.contact_shapes))


def force_psd():
    """Return the one-sided PSD in N²/Hz of the force of `linear_records`, whose RMS is 1."""
    return 1.0 / (LINEAR_BAND_HZ[1] - LINEAR_BAND_HZ[0])


def expected_psd(model, spectra, highest_Hz=LINEAR_BAND_HZ[1]):
    """Return (frequency (fine,) Hz, expected averaged PSD (fine,) m²/N²), between bins too.

    It is the true PSD convolved with |W|².
    """
    half = round(0.5 * LINEAR_RATE_HZ / FINE_HZ)
    frequency = (
        np.arange(2 * half) - half
    ) * FINE_HZ  # one period of the sampled spectrum, zero in the middle
    inside = (np.abs(frequency) > LINEAR_BAND_HZ[0]) & (np.abs(frequency) < LINEAR_BAND_HZ[1])
    density = np.zeros(frequency.size)
    density[inside] = true_psd(model, np.abs(frequency[inside]))
    length = round(spectra.segment_s * LINEAR_RATE_HZ)
    kernel = np.roll(power_kernel(spectra.window, frequency * spectra.segment_s, length), half)
    seen = (
        np.fft.irfft(np.fft.rfft(kernel) * np.fft.rfft(density), density.size)
        * FINE_HZ
        * spectra.segment_s
    )
    kept = (frequency > 0.0) & (frequency <= highest_Hz)
    return frequency[kept], seen[kept]


def _half_width(peak, frequency, psd):
    """Return (highest value, half-power width / (2 f)) of a PSD (fine,) within 3 Hz of a peak."""
    near = np.where(np.abs(frequency - peak) < 3.0, psd, 0.0)
    above = np.flatnonzero(near >= 0.5 * near.max())
    return near.max(), (above[-1] - above[0] + 1) * (frequency[1] - frequency[0]) / (2.0 * peak)


def _shape(model):
    """Return (mode, 1) the shapes of POINT."""
    return model.sensor_shapes[:, [model.sensor_names.index(POINT)]]


def _row(record, setting, frequency, theory, measured):
    """Return a row of `noise_rows`."""
    keys = dict(zip(("segment_s", "overlap", "duration_s", "window"), setting, strict=True))
    return {
        "record": record,
        **keys,
        "frequency_Hz": frequency,
        "nu_flat": theory[0],
        "nu_resonance": theory[1],
        "nu_measured": measured[0],
        "standard_error": measured[1],
        "scatter_dB": scatter_dB(measured[0]),
        "scatter_flat_dB": scatter_dB(theory[0]),
    }


def published_checks():
    """Return the Checks of the effective averages by formula against the published ones."""
    return [
        Check(
            CASE,
            f"degrees of freedom, {duration:g} s in buffers of {segment:g} s, {overlap:.0%}"
            " overlap, Hann",
            "1",
            value,
            "unit values of the formula of Welch (1967), one decimal",
            float(effective_averages(duration, 2048.0, averaging(segment, overlap, "hann"))),
            PUBLISHED_ROUNDING,
            1.0,
        )
        for (segment, overlap, duration), value in PUBLISHED.items()
    ]


def measured_checks(rows):
    """Return the Checks of measured degrees of freedom and peak levels.

    White noise is compared with the formula for a flat spectrum, peaks with that of a resonance.
    """
    checks = []
    for row in rows:
        setting = (
            f"{row['duration_s']:g} s, {row['segment_s']:g} s, {row['overlap']:.0%},"
            f" {row['window']}"
        )
        if row["record"] == "white noise":
            checks.append(
                Check(
                    CASE,
                    f"degrees of freedom of white noise, {setting}",
                    "1",
                    row["nu_flat"],
                    "Welch (1967)",
                    row["nu_measured"],
                    NOISE_TOLERANCE,
                )
            )
            continue
        place = f"{row['frequency_Hz']:.1f} Hz, {setting}"
        checks.append(
            Check(
                CASE,
                f"degrees of freedom of a peak at {place}",
                "1",
                row["nu_resonance"],
                "Welch (1967) with the resonance's PSD",
                row["nu_measured"],
                STANDARD_ERRORS * row["standard_error"],
                1.0,
            )
        )
        checks.append(
            Check(
                CASE,
                f"level of a peak over the true one at {place}",
                "dB",
                row["level_expected_dB"],
                "PSD convolved with the window",
                row["level_dB"],
                STANDARD_ERRORS * row["level_error_dB"],
                1.0,
            )
        )
    return checks


def averages_rows(model, study_seed):
    """Return the rows of `noise_rows` and `linear_rows`; NaN in columns that white noise lacks."""
    missing = dict.fromkeys(("level_dB", "level_error_dB", "level_expected_dB"), np.nan)
    return [row | missing for row in noise_rows(study_seed)] + linear_rows(
        model, linear_records(model, study_seed)
    )


def checks(rows):
    """Return all Checks of the topic, from `averages_rows`."""
    return published_checks() + measured_checks(rows)
