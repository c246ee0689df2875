"""The output filter meets its mask, and acceleration is the second derivative of displacement."""

import numpy as np
import pytest

from vibroimpact.integration.output_filter import output_filter

RATE, SAMPLING = 51200.0, 2048.0


@pytest.mark.parametrize("steps_per_second", [51200.0, 102400.0, 204800.0])
def test_filter_response_meets_the_mask(steps_per_second):
    design = output_filter(steps_per_second, SAMPLING)
    frequency = np.linspace(0.0, steps_per_second / 2, 40001)
    level = 20 * np.log10(np.maximum(np.abs(design.response(frequency, steps_per_second)), 1e-12))
    assert np.max(np.abs(level[frequency <= 800.0])) < 0.05
    assert np.max(level[frequency >= 1024.0]) < -80.0


def test_phase_weights_spread_every_tap_once():
    """The weights of one output over the six ticks that feed it are the taps in order."""
    design = output_filter(RATE, SAMPLING)
    weights = design.phase_weights()
    taps = np.concatenate(
        [weights[:, slot] for slot in range(5, -1, -1)]
    )  # an output is in the last slot at first, in slot 0 at last
    assert np.array_equal(taps[1:], design.first)
    assert taps[0] == 0.0


def test_second_derivative_of_a_sine():
    design = output_filter(RATE, SAMPLING)
    delay, middle = design.delay, RATE / 5
    n = np.arange(-delay, delay + 1)
    for frequency in (16.0, 200.0, 790.0):
        wave = np.cos(2 * np.pi * frequency * n / middle)
        displacement, acceleration = design.second @ wave, design.second_derivative @ wave
        assert acceleration / displacement == pytest.approx(
            -((2 * np.pi * frequency) ** 2), rel=1e-5
        )


def test_first_derivative_of_a_sine():
    """Of a cosine the derivative is less sine, a quarter of a period later in the filter's taps."""
    design = output_filter(RATE, SAMPLING)
    delay, middle = design.delay, RATE / 5
    n = np.arange(-delay, delay + 1)
    for frequency in (16.0, 200.0, 790.0):
        phase = 2 * np.pi * frequency * n / middle
        displacement, velocity = design.second @ np.cos(phase), design.taps(1) @ np.sin(phase)
        assert velocity / displacement == pytest.approx(2 * np.pi * frequency, rel=1e-5)
        assert abs(design.taps(1) @ np.cos(phase)) < 1e-9 * 2 * np.pi * frequency


@pytest.mark.parametrize(
    ("rate", "stages"), [(1024.0, 4), (2048.0, 2), (5000.0, 2), (5000.0, 3), (8192.0, 2)]
)
def test_pass_band_is_flat_at_any_sampling_rate(rate, stages):
    design = output_filter(5 * stages * rate, rate)
    frequency = np.linspace(0.0, 0.78 * rate / 2, 500)
    level = 20 * np.log10(design.response(frequency, 5 * stages * rate))
    assert np.max(np.abs(level)) < 0.05


def test_one_stage_stops_the_images_of_the_pass_band():
    rate, steps = 2048.0, 10240.0
    design = output_filter(steps, rate)
    assert design.step == 1
    passed = np.linspace(0.0, 0.78 * rate / 2, 500)
    level = 20 * np.log10(design.response(passed, steps))
    images = design.response(np.concatenate([rate - passed, 2 * rate + passed]), steps)
    assert np.max(np.abs(level)) < 0.001
    assert 20 * np.log10(np.max(np.abs(images))) < -50.0


def test_rates_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="must be a multiple of 5: choose .* of 5120 Hz divided"):
        output_filter(25600.0, 2048.0)
    with pytest.raises(ValueError, match="must be a multiple of 5"):
        output_filter(20480.0, 8192.0)
