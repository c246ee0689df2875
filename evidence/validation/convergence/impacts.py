"""Scatter of levels over seeds when the tube impacts, against that of Gaussian records.

Length, buffers and overlap are the same. The level of a band is the mean of the PSD over its bins.
For a Gaussian record its variance follows from nu and from the correlation of neighbouring bins,
and averaging over more bins reduces it. With impacts the levels drift slowly, all bins of a band
together; the level of a band shows it, a single bin hardly does. Loads without contact are the
control.
"""

import numpy as np

from evidence.validation.check import Check
from vibroimpact.config.reading import changed_config
from vibroimpact.identify.spectra.welch import effective_averages
from vibroimpact.identify.spectra.window_leakage import spectral_kernel
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import Case
from vibroimpact.study.simulation import simulate_cases

from .spectra import CASE, DECIBEL, POINT, averaging, estimates_of

LOADS_N = (0.2, 2.0, 5.0, 20.0)  # no, first, intermediate contact; contact half of the time
SEEDS = 16
SETTINGS = ((10.0, 0.65), (5.0, 0.5), (2.0, 0.5))  # buffer s, overlap; Hann
BAND_HZ = (6.0, 195.0)
# Widths of the bands that fill BAND_HZ; those narrower than a bin are left out.
WIDTHS_HZ = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
WIDE_HZ = 20.0
EXPECTED_MULTIPLE = (2.0, 9.0)  # of the Gaussian variance, for levels of bands at impact loads
STANDARD_ERRORS = 3.0


def impact_spectra(config, loads=LOADS_N, seeds=SEEDS, settings=SETTINGS):
    """Return (spectra, contact) of records of the configuration's length at its largest gap.

    spectra: {(load N, buffer s, overlap): (frequency (frequency,) Hz, PSD (seed, frequency) m²/Hz
    at POINT)}.
    contact: {load: fraction of time in contact}.
    """
    run = changed_config(config, {"grid.seeds": seeds})
    model, rate = build_model(run), run.record.sampling_frequency_Hz
    found, contact = {}, {}
    for load in loads:
        records, fractions = [], []
        for _, record in simulate_cases(
            run, model, [Case(load, max(run.grid.gap_m), seed) for seed in range(seeds)]
        ):
            records.append(
                record["displacement"].values[list(record["sensor"].values).index(POINT)]
            )
            fractions.append(float(record["contact_fraction"].mean()))
        contact[load] = float(np.mean(fractions))
        for segment, overlap in settings:
            found[load, segment, overlap] = estimates_of(
                np.array(records, dtype=float), rate, averaging(segment, overlap, "hann")
            )
    return found, contact


def impact_rows(config, found, contact):
    """Return one row per load, setting and width of the bands: variance over the Gaussian one.

    Row keys: load_rms_N, contact_fraction, segment_s, overlap, width_Hz, bins (per band), multiple
    (mean over bands of variance over Gaussian variance), standard_error (jackknife over seeds),
    scatter_dB (of a level, to first order), scatter_gaussian_dB.
    """
    rows = []
    record = config.record
    for (load, segment, overlap), (frequency, psd) in found.items():
        nu = effective_averages(
            record.duration_s, record.sampling_frequency_Hz, averaging(segment, overlap, "hann")
        )
        correlation = spectral_kernel("hann", segment).bin_correlation
        inside = psd[:, (frequency >= BAND_HZ[0]) & (frequency <= BAND_HZ[1])]
        for width in WIDTHS_HZ:
            bins = round(width * segment)
            if abs(bins - width * segment) > 1.0e-9 or bins < 1:
                continue
            multiple, gaussian = variance_multiple(inside, bins, nu, correlation)
            left_out = np.array(
                [
                    variance_multiple(np.delete(inside, seed, axis=0), bins, nu, correlation)[0]
                    for seed in range(len(inside))
                ]
            )
            error = np.sqrt(
                (len(inside) - 1) / len(inside) * np.sum((left_out - left_out.mean()) ** 2)
            )
            rows.append(
                {
                    "load_rms_N": load,
                    "contact_fraction": contact[load],
                    "segment_s": segment,
                    "overlap": overlap,
                    "width_Hz": width,
                    "bins": bins,
                    "multiple": multiple,
                    "standard_error": error,
                    "scatter_dB": DECIBEL * np.sqrt(multiple * gaussian),
                    "scatter_gaussian_dB": DECIBEL * np.sqrt(gaussian),
                }
            )
    return rows


def variance_multiple(psd, bins, nu, correlation):
    """Return (variance of band levels over the Gaussian one, Gaussian variance / mean²).

    Both are means over the bands; the variance is over seeds.

    psd (seed, frequency): cut into bands of `bins` bins.
    correlation (distance,): squared correlation of bins 0, 1, ... apart.
    """
    bands = psd.shape[1] // bins
    levels = psd[:, : bands * bins].reshape(len(psd), bands, bins)
    mean = levels.mean(axis=0)
    gaussian = np.zeros(bands)
    for distance, share in enumerate(correlation[:bins]):
        gaussian += (
            (1.0 if distance == 0 else 2.0)
            * share
            * np.sum(mean[:, distance:] * mean[:, : bins - distance], axis=1)
        )
    gaussian *= 2.0 / nu
    return float(np.mean(levels.sum(axis=2).var(axis=0, ddof=1) / gaussian)), float(
        np.mean(gaussian / mean.sum(axis=1) ** 2)
    )


def impact_checks(rows):
    """Return the Checks of the variance with the study's buffers.

    Without contact it is Gaussian, for bins and bands. With impacts it is 2 to 9 times the Gaussian
    one for wide bands, while a single bin stays near it.
    """
    checks = []
    for row in rows:
        study = (row["segment_s"], row["overlap"]) == SETTINGS[0]
        if not study or (row["width_Hz"] != WIDE_HZ and row["bins"] > 1):
            continue
        name = (
            f"seed variance of levels over the Gaussian one, bands of {row['width_Hz']:g} Hz,"
            f" {row['load_rms_N']:g} N"
        )
        if row["contact_fraction"] == 0.0:
            checks.append(
                Check(
                    CASE,
                    name,
                    "1",
                    1.0,
                    "Welch (1967): Gaussian record",
                    row["multiple"],
                    float(STANDARD_ERRORS * row["standard_error"]),
                    1.0,
                )
            )
        elif row["bins"] > 1:
            low, high = EXPECTED_MULTIPLE
            checks.append(
                Check(
                    CASE,
                    name,
                    "1",
                    0.5 * (low + high),
                    f"{low:g} to {high:g} times, prototypes",
                    row["multiple"],
                    0.5 * (high - low),
                    1.0,
                )
            )
    return checks
