"""Known poles come back from the least-squares complex frequency estimator, and the chart tells
stable from unstable ones.
"""

import numpy as np
import pytest

from vibroimpact.identify.linear.poles import frequency_of, pole_of
from vibroimpact.identify.lscf import NormalEquations
from vibroimpact.identify.operational_pole import (
    PoleSearch,
    cramer_rao_covariance,
    half_spectra,
    lag_window,
    operational_pole,
)
from vibroimpact.identify.spectra.window_leakage import window_autocorrelation
from vibroimpact.identify.stabilisation import (
    StabilisationChart,
    first_stable_order,
    nearest_pole,
    stabilisation_chart,
)

FREQUENCIES = np.array([12.0, 21.0, 33.0])
RATIOS = np.array([0.01, 0.025, 0.004])
SHAPES = np.array([[1.0, 0.4, -0.8], [0.7, -1.0, 0.5], [0.3, 0.9, 1.0]])  # (output, mode)


def responses(frequency, drive):
    """Receptances (output, drive, frequency) of three modes, forces at the outputs named by
    drive.
    """
    omega, modal = 2.0 * np.pi * frequency, 2.0 * np.pi * FREQUENCIES
    receptance = 1.0 / (modal**2 - omega[:, None] ** 2 + 2j * RATIOS * modal * omega[:, None])
    return np.einsum("om,dm,fm->odf", SHAPES, SHAPES[drive], receptance)


def known_among(poles, of_frequency, of_ratio):
    """The index of each known pole, which is there within two relative errors."""
    chosen = [
        nearest_pole(poles, pole_of(*known), 1.0) for known in zip(FREQUENCIES, RATIOS, strict=True)
    ]
    frequency, ratio = frequency_of(poles[chosen])
    assert frequency == pytest.approx(FREQUENCIES, rel=of_frequency)
    assert ratio == pytest.approx(RATIOS, rel=of_ratio)
    return chosen


@pytest.mark.parametrize("drive", [[0], [0, 1]])
def test_known_poles_come_back_from_frequency_responses(drive):
    frequency = np.arange(5.0, 45.0, 0.05)
    poles, participation = NormalEquations(frequency, responses(frequency, drive), 16).poles(16)
    chosen_poles = known_among(poles, 1.0e-7, 1.0e-5)
    if len(drive) == 2:  # the participations are the modes' shapes at the drives
        for mode, chosen in enumerate(chosen_poles):
            ratio_of_drives = participation[chosen, 1] / participation[chosen, 0]
            assert ratio_of_drives == pytest.approx(SHAPES[1, mode] / SHAPES[0, mode], rel=1.0e-4)


def test_half_spectra_hold_each_mode_once_with_its_decay():
    frequency = np.arange(0.0, 128.01, 0.05)
    weights, decay = lag_window("none", 2 * (frequency.size - 1), 20.0, 5.0)
    assert decay == pytest.approx(np.log(100.0) / 5.0)
    band = slice(100, 900)
    response = responses(frequency, [0])[:, 0]  # to a unit white force on output 0
    values = half_spectra(response[:, None] * response[:2].conj(), weights, band)
    known_among(NormalEquations(frequency[band], values, 16).poles(16)[0] + decay, 2.0e-4, 0.02)


@pytest.mark.parametrize("window", ["hann", "boxcar", "none"])
def test_half_spectra_undo_the_window_and_count_lag_0_half(window):
    samples, segment_s, rate = 1280, 10.0, 128.0
    lag = np.arange(samples) / rate
    correlation = np.exp(-1.5 * lag) * np.cos(2.0 * np.pi * 12.0 * lag)
    weighted = correlation * window_autocorrelation(window, samples, samples)
    symmetric = np.concatenate([weighted[: samples // 2 + 1], weighted[1 : samples // 2][::-1]])
    weights, decay = lag_window(window, samples, segment_s, 2.0)
    found = half_spectra(np.fft.rfft(symmetric).real, weights, slice(50, 200))
    kept = correlation[:256] * np.exp(-decay * lag[:256])
    kept[0] *= 0.5
    expected = np.exp(-2j * np.pi * np.outer(np.arange(50, 200) / segment_s, lag[:256])) @ kept
    np.testing.assert_allclose(found, expected, atol=1.0e-6)
    assert kept[-1] / correlation[255] == pytest.approx(0.01, rel=0.05)


def random_record(seed, seconds=120):
    """Segment spectra (output, segment, frequency) of the three outputs under white noise, 10 s
    Hann segments with half overlap.
    """
    rate, samples = 128, 128 * (seconds + 10)
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    force = np.fft.rfft(np.random.default_rng(seed).standard_normal(samples))
    motion = np.fft.irfft(responses(frequency, [0])[:, 0] * force, samples)[:, -seconds * rate :]
    window = np.hanning(10 * rate + 1)[:-1]
    parts = [
        motion[:, start : start + 10 * rate] * window
        for start in range(0, (seconds - 10) * rate + 1, 5 * rate)
    ]
    return np.fft.rfft(np.stack(parts, axis=1), axis=-1)


def test_known_pole_within_its_standard_error():
    search = PoleSearch(np.arange(641) * 0.1, (5.0, 45.0), "hann", 12)
    found = [
        operational_pole(random_record(seed), (0, 1), search, (21.0, 1.0), 30.0, 120.0)
        for seed in range(16)
    ]
    errors = np.array([(pole.frequency, pole.damping_ratio) for pole in found]) - (21.0, 0.025)
    scores = errors / np.sqrt([np.diag(pole.covariance) for pole in found])
    assert np.abs(errors.mean(axis=0) / (21.0, 0.025)) == pytest.approx(np.zeros(2), abs=0.06)
    size = np.sqrt(np.mean(scores**2, axis=0))
    assert np.all((0.5 < size) & (size < 2.0))
    size = errors.std(axis=0) / np.sqrt(np.diag(cramer_rao_covariance(21.0, 0.025, 120.0)))
    assert np.all((0.7 < size) & (size < 2.5))


def chart(*columns):
    """A chart of (order, [(frequency, ratio, stable), ...]) columns."""
    rows = [(order, pole_of(*pole), stable) for order, poles in columns for *pole, stable in poles]
    order, pole, stable = map(np.array, zip(*rows, strict=True))
    return StabilisationChart(order, pole, stable, stable, stable)


def test_the_first_order_with_one_stable_pole_is_taken():
    start, first, one = pole_of(20.0, 0.05), (3, [(20.0, 0.06, False)]), [(20.1, 0.05, True)]
    calm = chart(first, (4, [*one, (45.0, 0.01, True)]), (5, one))
    assert first_stable_order(calm, start, 3.0) == (4, True)
    late = chart(first, (4, [(20.1, 0.05, False)]), (5, one))
    assert first_stable_order(late, start, 3.0) == (5, True)
    split = [(18.5, 0.04, True), (21.2, 0.04, True)]  # a broad peak in two: skipped
    broad = chart(first, (4, [(20.0, 0.05, False)]), (5, split), (6, split))
    assert first_stable_order(broad, start, 3.0) == (4, False)
    early = chart(first, (4, [(18.5, 0.04, False), (21.2, 0.04, False)]))
    assert first_stable_order(early, start, 3.0) == (3, False)


def test_flags_compare_with_the_order_before():
    frequency = np.arange(5.0, 45.0, 0.1)
    equations = NormalEquations(frequency, responses(frequency, [0, 1]), 14)
    found = stabilisation_chart(equations, 0.0, range(2, 15))
    last = found.order == 14
    for known in zip(FREQUENCIES, RATIOS, strict=True):
        assert found.stable[last][nearest_pole(found.pole[last], pole_of(*known), 1.0)]
    assert not found.stable[found.order == 2].any()
