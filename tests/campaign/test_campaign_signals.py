"""The signals of a campaign in SI: units, valid samples, and the band that the force excites."""

import numpy as np
import pytest

from vibroimpact.campaign.file import CampaignError, Channel, Level, campaign_dataset
from vibroimpact.campaign.signals import campaign_signals, excited_band, transfer_band

RATE, SAMPLES = 512.0, 16384


def campaign(units=("g", "mm")):
    """Two records of a force from 20 to 80 Hz; the second one ends early."""
    rng = np.random.default_rng(4)
    lines = np.zeros((2, SAMPLES // 2 + 1), complex)
    frequency = np.fft.rfftfreq(SAMPLES, 1.0 / RATE)
    inside = (frequency >= 20.0) & (frequency <= 80.0)
    lines[:, inside] = rng.standard_normal((2, inside.sum())) + 1j * rng.standard_normal(
        (2, inside.sum())
    )
    force = np.fft.irfft(lines, SAMPLES) * np.array([[1.0], [4.0]]) * 100.0
    response = np.stack([2.0 * force, -3.0 * force], axis=1)
    channels = [
        Channel("top", (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), units[0], "acceleration"),
        Channel("leg", (0.0, 0.0, 0.5), (0.0, 1.0, 0.0), units[1], "displacement"),
    ]
    drive = Channel("shaker", (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), "kN", "force")
    levels = [Level("low", 2.0e-4), Level("high", 3.0e-4, split="holdout")]
    made = campaign_dataset(
        force[:, None], response, channels, [drive], levels, RATE, source="a test"
    )
    return made.assign(valid_samples=("record", np.array([SAMPLES, SAMPLES - 100])))


def test_signals_are_in_si_and_cut_to_their_valid_samples():
    made = campaign()
    signals = campaign_signals(made)
    stored = made["response"].values[1].astype(float)
    assert signals.valid_samples.tolist() == [SAMPLES, SAMPLES - 100]
    assert signals.factors == pytest.approx([9.80665, 1.0e-3])
    np.testing.assert_allclose(signals.response[1][0], 9.80665 * stored[0, :-100], rtol=1e-12)
    force = made["force"].values[0, 0].astype(float)
    np.testing.assert_allclose(signals.force[0][0], 1000.0 * force, rtol=1e-12)
    assert signals.gap.tolist() == [2.0e-4, 3.0e-4] and signals.splits == ["fit", "holdout"]


def test_padded_signals_are_nan_beyond_the_valid_samples():
    force, response = campaign_signals(campaign()).padded(SAMPLES)
    assert force.shape == (2, 1, SAMPLES) and response.shape == (2, 2, SAMPLES)
    assert np.isnan(force[1, :, -100:]).all() and np.isnan(response[1, :, -100:]).all()
    assert np.isfinite(force[0]).all() and np.isfinite(response[1, :, :-100]).all()


def test_a_unit_that_is_not_known_is_refused_where_it_matters():
    signals = campaign_signals(campaign(units=("furlong", "mm")))
    assert signals.factors[0] == 1.0 and list(signals.unit_faults) == [0]
    with pytest.raises(CampaignError, match="top has the unit 'furlong'"):
        signals.require_units()


def test_both_bands_are_those_of_the_force():
    signals = campaign_signals(campaign())
    force, _ = signals.padded(SAMPLES)
    for band in (excited_band(force, RATE), transfer_band(signals)):
        assert band == pytest.approx((20.0, 80.0), abs=0.8)
