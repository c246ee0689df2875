"""The noise of a channel: the floor of its spectrum, also where impacts lie above the excited
band.
"""

import numpy as np
import pytest

from tests.support.band_campaign import campaign
from vibroimpact.diagnosis.measurement.signals import noise_of, signals_of

RATE, BAND = 2048.0, (5.0, 200.0)


def seen(seconds, *filled, strength=(10.0, 10.0)):
    """(channel, sample) of white noise of RMS 0.1 and 1, with a response so many times as strong in
    bands (low, high) Hz.
    """
    samples, rng = int(seconds * RATE), np.random.default_rng(4)
    noise = np.array([[0.1], [1.0]])
    frequency = np.fft.rfftfreq(samples, 1.0 / RATE)
    response = np.zeros((2, samples))
    for (low, high), times in zip(filled, strength, strict=False):
        spectrum = np.fft.rfft(rng.standard_normal((2, samples))) * (
            (frequency >= low) & (frequency < high)
        )
        response += times * noise * np.fft.irfft(spectrum, samples)
    return noise * rng.standard_normal((2, samples)) + response


def noise(campaign, response, rate, band):
    """The noise of responses of which no force is looked at."""
    return noise_of(campaign, (np.zeros((1, response.shape[-1])), response), rate, band)


@pytest.mark.parametrize("seconds", [10, 20, 49])
def test_noise_without_contact_is_the_level_above_the_band(seconds):
    assert noise({}, seen(seconds, BAND), RATE, BAND) == pytest.approx([0.1, 1.0], rel=0.05)


@pytest.mark.parametrize("seconds", [20, 49])
def test_impacts_are_not_noise(seconds):
    assert noise({}, seen(seconds, (9.0, 1024.0)), RATE, BAND) == pytest.approx([0.1, 1.0], rel=0.2)


def test_noise_is_bounded_by_the_quietest_band():
    assert noise({}, seen(20, (0.0, 100.0), (100.0, 1024.0)), RATE, BAND) == pytest.approx(
        [1.0, 10.0], rel=0.1
    )


def test_impacts_that_fade_with_frequency_are_not_noise():
    """As at 0.5 N a stop met now and then: three times the noise's density above the band, and
    nothing but noise in the uppermost fifth.
    """
    assert noise(
        {}, seen(20, (5.0, 200.0), (200.0, 620.0), strength=(10.0, 1.4)), RATE, BAND
    ) == pytest.approx([0.1, 1.0], rel=0.05)


def test_single_quiet_band_does_not_set_the_noise():
    """Of a thousand channels of 20 s seven were read more than 0.5 dB low, one by 3.5 dB: what they
    hold was taken for motion then.
    """
    rng = np.random.default_rng(0)
    read = np.concatenate(
        [noise({}, rng.standard_normal((25, int(20 * RATE))), RATE, BAND) for _ in range(40)]
    )
    assert np.abs(20.0 * np.log10(read)).max() < 0.5


def test_noise_within_the_band_is_what_forces_do_not_explain():
    """Sampled for the band alone: two lightly damped modes under two forces, 40 dB above the noise,
    and a channel that does not move.
    """
    rate, band, samples, rng = 512.0, (5.0, 200.0), 512 * 20, np.random.default_rng(6)
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    inside = (frequency > band[0]) & (frequency < band[1])
    force = np.fft.rfft(rng.standard_normal((2, samples))) * inside
    transfer = [1.0 / (at**2 - frequency**2 + 0.01j * at * frequency) for at in (60.0, 130.0)]
    moves = np.fft.irfft(np.array([[1.0, 0.5], [0.3, -1.0]]) @ (force * transfer), samples)
    moves = np.vstack([moves / moves.std(axis=-1, keepdims=True), np.zeros(samples)])
    response = moves + 0.01 * rng.standard_normal(moves.shape)
    found = noise_of({}, (np.fft.irfft(force, samples), response), rate, band)
    assert found == pytest.approx([0.01, 0.01, 0.01], rel=0.25)


def test_measured_channel_is_as_noisy_as_what_is_simulated():
    """A channel across the motion, still until the tube touches, with less noise than a recorder
    resolves of its range.
    """
    dataset = campaign(RATE)
    dataset["response"][0, 1] *= 1.0e-12
    dataset["noise_floor_rms"][:] = 0.0
    signals = signals_of(dataset)
    largest = np.nanstd(signals.response[1, 1])
    assert signals.noise[1] == pytest.approx(1.0e-6 * largest, rel=0.01)
    assert np.nanstd(signals.response[0, 1]) == pytest.approx(signals.noise[1], rel=0.02)


def test_noise_of_a_record_follows_the_range_of_its_recorder():
    """White noise of one per cent of each record, without a statement of it."""
    dataset = campaign(RATE).drop_vars("noise_floor_rms", errors="ignore")
    for name in ("force", "response"):
        dataset[name][1] *= 20.0
    rng, clean = np.random.default_rng(8), dataset["response"].values
    level = np.nanstd(clean, axis=-1)
    dataset["response"].values = clean + 0.01 * level[..., None] * rng.standard_normal(clean.shape)
    signals = signals_of(dataset)
    lowest = int(np.argmin(signals.load))
    assert signals.record_noise[lowest] == pytest.approx(signals.noise)
    assert signals.record_noise == pytest.approx(0.01 * level, rel=0.15)
    stated = campaign(RATE)
    stated["noise_floor_rms"][:] = 0.1
    assert (signals_of(stated).record_noise == signals_of(stated).noise).all()
