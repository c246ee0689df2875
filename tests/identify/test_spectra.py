"""Averaged spectra: against scipy's, against closed forms, and what the analysis window does to
them.
"""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.signal
import xarray as xr

from vibroimpact.identify.spectra.welch import (
    complex_values,
    effective_averages,
    psd_statistics,
    segment_layout,
    segment_spectra,
)
from vibroimpact.identify.spectra.window_leakage import (
    correlated_sum,
    spectral_kernel,
    window_autocorrelation,
)
from vibroimpact.study.case_spectra import case_spectra

RATE = 256.0


def settings(segment_s=10.0, overlap=0.65, window="hann"):
    return SimpleNamespace(segment_s=segment_s, overlap=overlap, window=window)


@pytest.mark.parametrize("window", ["hann", "boxcar"])
@pytest.mark.parametrize("overlap", [0.0, 0.5, 0.65])
def test_psd_is_that_of_scipy(window, overlap):
    signal = np.random.default_rng(1).standard_normal((2, 49 * 256))
    spectra = segment_spectra(signal, RATE, settings(overlap=overlap, window=window))
    mean, low, high = psd_statistics(spectra.values)
    frequency, expected = scipy.signal.welch(
        signal, RATE, window, 2560, round(2560 * overlap), detrend=False
    )
    np.testing.assert_allclose(spectra.frequency, frequency)
    np.testing.assert_allclose(mean, expected, rtol=1.0e-10)
    assert np.all(low <= mean) and np.all(mean <= high) and np.any(low < 0.5 * mean)


def test_float32_records_stay_float32():
    signal = np.random.default_rng(3).standard_normal((1, 49 * 256))
    single = segment_spectra(signal.astype(np.float32), RATE, settings(), highest_Hz=60.0)
    assert single.values.dtype == np.complex64 and single.frequency[-1] == 60.0
    double = segment_spectra(signal, RATE, settings(), highest_Hz=60.0)
    np.testing.assert_allclose(single.values, double.values, atol=1.0e-5)


def test_a_segment_longer_than_the_record_is_an_error():
    with pytest.raises(ValueError, match="10 s does not fit in a record of 5 s"):
        segment_layout(5 * 256, RATE, 10.0, 0.65)
    with pytest.raises(ValueError, match="overlap = 1 leaves no step"):
        segment_layout(20 * 256, RATE, 10.0, 1.0)


def resonance_correlation(lag, frequency, ratio):
    """Correlation of the displacement of an oscillator under white noise, to a factor."""
    omega = 2.0 * np.pi * frequency
    damped = omega * np.sqrt(1.0 - ratio**2)
    return np.exp(-ratio * omega * lag) * (
        np.cos(damped * lag) + ratio * omega / damped * np.sin(damped * lag)
    )


@pytest.mark.parametrize("window", ["hann", "boxcar"])
def test_window_leakage_gives_the_expected_averaged_spectrum(window):
    # Another way to the same expectation: transform of the correlation times the window's
    # autocorrelation.
    rate, segment_s, place, ratio = 512.0, 10.0, 16.0, 0.015
    samples = round(rate * segment_s)
    lags = np.arange(samples)
    weighted = resonance_correlation(lags / rate, place, ratio)
    weighted *= window_autocorrelation(window, samples, samples)
    bins = np.arange(120, 201) / segment_s
    expected = 2.0 * np.cos(2.0 * np.pi * np.outer(bins, lags) / rate) @ weighted - weighted[0]
    kernel = spectral_kernel(window, segment_s)
    square = (kernel.fine_index(bins) * kernel.spacing_Hz / kernel.oversampling / place) ** 2
    smooth = kernel.smooth(1.0 / ((1.0 - square) ** 2 + 4.0 * ratio**2 * square))
    within = 2.0e-4 if window == "hann" else 0.02
    np.testing.assert_allclose(smooth / smooth.max(), expected / expected.max(), atol=within)


def test_neighbouring_bins_of_a_hann_window_are_correlated():
    kernel = spectral_kernel("hann", 10.0)
    np.testing.assert_allclose(kernel.bin_correlation, [1.0, 4.0 / 9.0, 1.0 / 36.0], atol=1.0e-12)
    signal = np.random.default_rng(6).standard_normal((40, 49 * 64))
    mean = psd_statistics(segment_spectra(signal, 64.0, settings()).values)[0][:, 10:-10]
    groups = mean[:, :280].reshape(40, 28, 10).sum(axis=2) / mean.mean()  # sums of 10 bins
    correlated = correlated_sum(np.ones((1, 10)), kernel)[0, 0]
    expected = 2.0 * correlated / effective_averages(49.0, 64.0, settings())
    assert groups.var() == pytest.approx(expected, rel=0.12)
    assert spectral_kernel("none", 10.0).smooth(np.arange(5.0)) == pytest.approx(np.arange(5.0))


def test_case_spectra_keep_what_figures_and_methods_read():
    generator = np.random.default_rng(7)
    config = SimpleNamespace(
        record=SimpleNamespace(sampling_frequency_Hz=256.0),
        spectra=settings(4.0, 0.5),
        excitation=SimpleNamespace(direction=(0.0, 1.0, 0.0)),
        identification=SimpleNamespace(
            lscf=SimpleNamespace(band_Hz=(8.0, 30.0)),
            broadband=SimpleNamespace(band_Hz=(6.0, 40.0)),
        ),
    )
    motion = generator.standard_normal((4, 20 * 256)).astype(np.float32)
    record = xr.Dataset(
        {
            "displacement": (("sensor", "time"), motion),
            "acceleration": (("sensor", "time"), 2.0 * motion),
            "line_displacement": (("line_point", "time"), motion[:3]),
        },
        {"sensor": ["a.x", "a.y", "b.x", "b.y"]},
        {"case": "one"},
    )
    spectra = case_spectra(config, record)
    assert list(spectra["driven_sensor"].values) == ["a.y", "b.y"]
    assert (spectra.attrs["case"], spectra.attrs["window"]) == ("one", "hann")
    assert spectra["low_frequency"].values[-1] == 60.0
    assert spectra["line_frequency"].values[[0, -1]].tolist() == [8.0, 30.0]
    power = np.abs(complex_values(spectra, "sensor_spectra")) ** 2
    mean = spectra["psd_displacement_mean"].values[[1, 3], : spectra["low_frequency"].size]
    np.testing.assert_allclose(power.mean(axis=1), mean, rtol=1.0e-4)
    largest = 4.0 * spectra["psd_displacement_max"]
    np.testing.assert_allclose(spectra["psd_acceleration_max"], largest, rtol=1.0e-4)
    assert float(spectra["effective_averages"]) == effective_averages(20.0, 256.0, config.spectra)
