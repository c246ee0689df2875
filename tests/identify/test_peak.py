"""Widths of a peak: exact inversion at every level, and the fit that reads them from a noisy,
windowed spectrum.
"""

import numpy as np
import pytest

from vibroimpact.identify.peak import (
    LEVELS,
    damping_from_width,
    find_peak,
    fit_peak,
    level_edges,
    resonance,
)
from vibroimpact.identify.spectra.window_leakage import spectral_kernel

FREQUENCY = np.arange(0, 601) * 0.1


def fitted(psd, kernel, level, **more):
    """The fit that starts at the main peak."""
    return fit_peak(FREQUENCY, psd, kernel, level, find_peak(FREQUENCY, psd, (8.0, 45.0)), **more)


def expected(place, ratio, kernel, size=3.0e-7):
    """The averaged spectrum of an oscillator that the window lets expect."""
    fine = kernel.fine_index(FREQUENCY) * kernel.spacing_Hz / kernel.oversampling
    return size * kernel.smooth(resonance(fine, np.log(place), np.log(ratio))[0])


@pytest.mark.parametrize("level", LEVELS.values())
@pytest.mark.parametrize("ratio", [1.0e-3, 0.015, 0.1])
def test_damping_from_width_inverts_width_from_damping(level, ratio):
    edges = level_edges(20.0, ratio, level)
    peak = 1.0 / (4.0 * ratio**2 * (1.0 - ratio**2))
    heights = resonance(np.array(edges), np.log(20.0), np.log(ratio))[0]
    assert heights == pytest.approx(np.full(2, peak / level), rel=1.0e-9)
    assert damping_from_width(edges, level) == pytest.approx((20.0, ratio), rel=1.0e-9)


def test_slopes_of_the_resonance():
    place, ratio, step = np.log(20.0), np.log(0.03), 1.0e-6
    frequency = np.linspace(15.0, 25.0, 41)
    curve, *slopes = resonance(frequency, place, ratio)
    moved = (
        resonance(frequency, place + step, ratio)[0],
        resonance(frequency, place, ratio + step)[0],
    )
    np.testing.assert_allclose(slopes, (moved - curve) / step, rtol=1.0e-3, atol=1.0e-3)


@pytest.mark.parametrize("window", ["hann", "boxcar", "none"])
@pytest.mark.parametrize("level", LEVELS.values())
def test_an_exact_spectrum_gives_its_pole_at_every_level(window, level):
    kernel = spectral_kernel(window, 10.0)
    psd = expected(21.3, 0.024, kernel)
    fit = fitted(psd, kernel, level)
    assert (fit.frequency, fit.damping_ratio) == pytest.approx((21.3, 0.024), rel=1.0e-5)
    np.testing.assert_allclose(fit.curve, psd[fit.bins], rtol=1.0e-5)


def test_ignoring_window_leakage_overestimates_damping():
    psd = expected(16.0, 0.015, spectral_kernel("hann", 10.0))
    blind = fitted(psd, spectral_kernel("none", 10.0), 2.0)
    assert 1.025 < blind.damping_ratio / 0.015 < 1.12


def test_noisy_spectra_give_unbiased_poles_and_errors():
    kernel, averages = spectral_kernel("none", 10.0), 18.0
    psd = expected(21.0, 0.025, kernel)
    generator = np.random.default_rng(11)
    for level in LEVELS.values():
        noise = generator.gamma(averages / 2.0, 2.0 / averages, (150, psd.size))
        fits = [fitted(psd * each, kernel, level, averages=averages) for each in noise]
        found = np.array([(fit.frequency, fit.damping_ratio) for fit in fits])
        errors = np.sqrt(np.mean([np.diag(fit.covariance) for fit in fits], axis=0))
        bias = (found.mean(axis=0) - (21.0, 0.025)) / (found.std(axis=0) / np.sqrt(150))
        assert np.all(np.abs(bias) < 3.0)
        np.testing.assert_allclose(errors / found.std(axis=0), 1.0, atol=0.25)


def test_no_resonance_gives_no_pole_or_a_wide_error():
    kernel = spectral_kernel("none", 10.0)
    line = np.full(FREQUENCY.size, 1.0e-12)
    line[200] = 1.0
    assert fitted(line, kernel, 2.0) is None
    with pytest.raises(ValueError, match="only 2 bins between 8 and 8.1 Hz"):
        find_peak(FREQUENCY, line, (8.0, 8.1))
