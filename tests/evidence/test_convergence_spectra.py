"""Effective averages and leakage of averaged spectra: formula against records, flat and resonant,
Gaussian and wandering.
"""

import numpy as np
import pytest

from evidence.validation.convergence import impacts, spectra
from vibroimpact.identify.spectra.window_leakage import spectral_kernel


def test_published_degrees_of_freedom():
    assert [check.row() for check in spectra.published_checks() if not check.passed] == []


def test_white_noise_has_the_degrees_of_freedom_of_the_formula(study_config):
    settings = ((10.0, 0.65, 49.0, "hann"), (10.0, 0.65, 49.0, "boxcar"), (2.0, 0.5, 49.0, "hann"))
    rows = spectra.noise_rows(study_config.seed, settings)
    assert [check.row() for check in spectra.measured_checks(rows) if not check.passed] == []


def test_ringing_across_buffers_costs_degrees_of_freedom(study_config, study_model):
    records = spectra.linear_records(study_model, study_config.seed, count=256)
    rows = spectra.linear_rows(
        study_model,
        records,
        ((10.0, 0.65, 49.0, "hann"), (1.0, 0.5, 49.0, "hann"), (2.0, 0.5, 49.0, "boxcar")),
    )
    assert [check.row() for check in spectra.measured_checks(rows) if not check.passed] == []
    short = [row for row in rows if row["segment_s"] == 1.0]
    assert all(
        row["nu_measured"] + 4.0 * row["standard_error"] < row["nu_flat"] for row in short
    )  # the flat formula is refuted


def test_a_buffer_without_ringing_has_the_flat_formula(study_model):
    # Half-way between the peaks the spectrum is flat over a bin.
    spectrum = spectra.averaging(10.0, 0.65, "hann")
    assert spectra.at_bin(study_model, 75.0, 49.0, spectrum)[1] == pytest.approx(17.8, rel=0.02)


@pytest.mark.parametrize("window", ["hann", "boxcar"])
def test_the_power_kernel_is_that_of_the_window(window):
    length = 64
    bins = np.arange(length * 8) / 8.0
    transform = np.abs(np.fft.fft(spectra.window_values(window, length), length * 8)) ** 2
    expected = transform / (length * np.sum(spectra.window_values(window, length) ** 2))
    assert spectra.power_kernel(window, bins, length) == pytest.approx(expected, abs=1e-12)
    assert expected.sum() / 8.0 == pytest.approx(1.0)


def test_expected_spectrum_has_bin_values_and_long_buffer_level(
    study_model,
):
    spectrum = spectra.averaging(5.0, 0.5, "hann")
    frequency, psd = spectra.expected_psd(study_model, spectrum)
    assert psd[np.argmin(np.abs(frequency - 45.0))] == pytest.approx(
        spectra.at_bin(study_model, 45.0, 49.0, spectrum)[0], rel=1e-3
    )
    rows = spectra.leakage_rows(study_model, segments_s=(10.0, 40.0))
    third = {(row["window"], row["segment_s"]): row for row in rows if row["peak_Hz"] > 100.0}
    assert abs(third["hann", 40.0]["level_dB"]) < 0.05 < abs(third["hann", 10.0]["level_dB"])
    assert third["hann", 40.0]["apparent_damping_ratio"] == pytest.approx(
        third["hann", 40.0]["damping_ratio"], rel=0.02
    )


def gaussian_estimates(seeds, wander):
    """Return (PSD (seed, frequency), nu, correlation of bins) of white noise whose level scatters
    by `wander` over the seeds.
    """
    generator = np.random.default_rng(5)
    averaging = spectra.averaging(10.0, 0.65, "hann")
    levels = 1.0 + wander * generator.standard_normal((seeds, 1))
    _, psd = spectra.estimates_of(
        np.sqrt(levels) * generator.standard_normal((seeds, 49 * 64)), 64.0, averaging
    )
    return (
        psd[:, 2:-2],
        spectra.effective_averages(49.0, 64.0, averaging),
        spectral_kernel("hann", 10.0).bin_correlation,
    )


@pytest.mark.parametrize("bins", [1, 10, 100])
def test_gaussian_record_has_unit_variance_ratio(bins):
    psd, nu, correlation = gaussian_estimates(200, 0.0)
    assert impacts.variance_multiple(psd, bins, nu, correlation)[0] == pytest.approx(1.0, abs=0.15)


def test_drifting_level_shows_in_bands_not_in_bins():
    psd, nu, correlation = gaussian_estimates(200, 0.1)
    narrow, wide = (impacts.variance_multiple(psd, bins, nu, correlation)[0] for bins in (1, 100))
    assert narrow < 1.3 and wide > 5.0
