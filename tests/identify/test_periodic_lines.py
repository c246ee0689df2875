"""Lines of periodic records: what goes in at known lines comes back, noise and distortion apart."""

import numpy as np
import pytest

from vibroimpact.identify.spectra.periodic_lines import PeriodError, find_period, level_lines

PERIOD, RATE = 1024, 256.0


def signal(lines, period=PERIOD):
    """(time,) with complex amplitudes {line: c} of c exp(i omega t) and its conjugate."""
    time = np.arange(period)
    return sum(
        2.0 * np.real(c * np.exp(2j * np.pi * line * time / period)) for line, c in lines.items()
    )


def test_amplitudes_come_back_and_the_transient_is_left_out():
    force, answer = signal({8: 1.0 + 0.5j, 20: -0.3j}), signal({8: 0.2j, 20: 1.5})
    records = np.tile(answer, 5)
    records[:PERIOD] += 100.0 * np.exp(-np.arange(PERIOD) / 50.0)
    level = level_lines("one", "fit", np.tile(force, 5), records[None], RATE, PERIOD, 1)
    assert level.periods == 4 and level.frequency[8] == pytest.approx(2.0)
    assert level.force[[8, 20]] == pytest.approx([1.0 + 0.5j, -0.3j])
    assert level.response[0, [8, 20]] == pytest.approx([0.2j, 1.5])
    assert level.load_rms == pytest.approx(np.sqrt(2.0 * (1.25 + 0.09)))
    assert level.rms((1.0, 6.0)) == pytest.approx([np.sqrt(2.0 * (0.04 + 2.25))])


def test_noise_is_the_scatter_of_the_mean():
    generator = np.random.default_rng(1)
    count, size = 400, 0.3
    force = np.tile(signal({5: 1.0}), count)
    noisy = force + size * generator.standard_normal(force.size)
    level = level_lines("noisy", "fit", force, noisy[None], RATE, PERIOD, 0)
    # A line of white noise has the variance size²/PERIOD, its mean over the periods a count-th of
    # it.
    expected = size / np.sqrt(PERIOD * count)
    assert np.median(level.noise[0, 10:400]) == pytest.approx(expected, rel=0.05)
    assert np.abs(level.response[0, 10:400]).mean() < 2.0 * expected


@pytest.mark.parametrize(("period", "count"), [(8192, 3), (1000, 7), (512, 9)])
def test_the_period_is_found(period, count):
    force = np.tile(np.random.default_rng(period).standard_normal(period), count)
    found = find_period(force)
    assert found % period == 0 and 2 * found <= force.size
    assert np.array_equal(force[:found], force[found : 2 * found])


def test_period_is_found_in_a_record_of_fractional_periods():
    force = np.resize(np.random.default_rng(7).standard_normal(1234), 6543)
    assert find_period(force) % 1234 == 0


def test_record_without_period_is_refused():
    with pytest.raises(PeriodError, match="does not repeat within 5000 samples"):
        find_period(np.random.default_rng(1).standard_normal(5000))
