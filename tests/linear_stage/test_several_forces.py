"""Two measured shakers at once, one along and one across: the lowest record tells the modes of
both, whatever of the one force is in the other.
"""

import numpy as np
import pytest

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.campaign.signals import excited_band
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.linear_stage import nuisance as linear
from vibroimpact.linear_stage.driven_channels import driven_channels
from vibroimpact.linear_stage.goodness_of_fit import LinearMisfit
from vibroimpact.linear_stage.linear_analysis import mixed_up
from vibroimpact.linear_stage.workbench import Workbench, corrected_nuisance
from vibroimpact.observation.attached_model import attach
from vibroimpact.observation.simulated_records import Forces, schedule_of, simulate_records

RATE, SECONDS, GAP = 2048.0, 16.0, 2.8886e-4
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
BEND, APEX, LEG = (-0.2121, 0.0, 0.9121), (0.0, 0.0, 1.0), (-0.3, 0.0, 0.55)
PLACES = (("apex y", APEX, Y), ("leg y", LEG, Y), ("apex x", APEX, X), ("leg x", LEG, X))
FACTOR, DAMPED = 1.004, 1.15


@pytest.fixture(scope="module")
def rig(study_config):
    """(Workbench, modes whose frequency and damping are not the model's): one along, one across."""
    samples = int(RATE * SECONDS)
    first, second = (
        band_limited_noise(np.random.default_rng(seed), samples, RATE, (5.0, 200.0))
        for seed in (1, 2)
    )
    force = np.stack([0.2 * first, 0.05 * first + 0.2 * second])
    force = np.stack([force, 10.0 * force])
    drives = [Channel("along", BEND, Y, "N", "generic"), Channel("across", BEND, X, "N", "generic")]

    def campaign_of(response):
        channels = [Channel(*place, "m s-1", "velocity") for place in PLACES]
        levels = [Level("low", GAP), Level("high", GAP)]
        return campaign_dataset(force, response, channels, drives, levels, RATE, start_up="rest")

    blank = campaign_of(np.zeros((2, len(PLACES), samples)))
    model = attach(study_config, blank)
    modes = np.array([np.flatnonzero(np.abs(model.drive_shapes[:, n]) > 0.3)[0] for n in (0, 1)])
    told = linear.Nuisance(modes, np.full(2, FACTOR), np.full(2, DAMPED), np.ones(len(PLACES)))
    schedule = schedule_of(blank, study_config.integration, SECONDS)
    true = simulate_records(
        linear.corrected(model, told),
        schedule,
        Forces(force, schedule),
        [(0, GAP, 0)],
        ["velocity"] * len(PLACES),
    )[0]
    noise = 0.01 * true.std() * np.random.default_rng(4).standard_normal(true.shape)
    return Workbench(study_config, campaign_of(np.stack([true + noise] * 2))), modes


def test_modes_that_either_force_drives_are_read_back(rig):
    bench, modes = rig
    fit = bench.measured_fit
    for mode in modes:
        place = list(fit.modes).index(mode)
        assert np.exp(fit.log_frequency[place]) == pytest.approx(FACTOR, abs=3e-4)
        assert np.exp(fit.log_damping[place]) == pytest.approx(DAMPED, abs=0.06)
    assert fit.residual.max() < 1.5 and not fit.delay.any()


def test_each_mode_counts_where_one_force_drives_it(rig):
    bench, modes = rig
    reading = bench.measured_reading
    assert (np.abs(reading.participation).max(axis=0) > 0.0).all()
    _, score, chi_square, pulls = corrected_nuisance(bench)
    values = linear.difference(bench.measured_reading, bench.bare_reading)[0]
    assert np.isfinite(score) and chi_square < 2.0 * len(values)
    for mode in modes:
        place = list(bench.measured_fit.modes).index(mode)
        assert pulls[place] == pytest.approx(np.log(FACTOR) / 0.003, abs=0.2)


def test_sense_of_a_mode_does_not_matter():
    drive = np.array([[0.2, 1.0], [-1.0, 0.9], [1.0, -1.0]])
    size = np.array([np.hypot(*row) for row in drive])
    np.testing.assert_allclose(linear.driven(drive), size * [1.0, -1.0, 1.0])
    np.testing.assert_allclose(linear.driven(-drive), -linear.driven(drive))
    np.testing.assert_array_equal(linear.driven(drive[:, :1]), drive[:, 0])


def test_no_channel_seems_swapped_under_two_forces(rig):
    bench, _ = rig
    assert mixed_up(bench) == []
    assert driven_channels(bench).all()


def test_band_is_that_of_both_forces():
    low, high = (
        band_limited_noise(np.random.default_rng(1), 16384, RATE, band)
        for band in ((10.0, 60.0), (100.0, 300.0))
    )
    band = excited_band(np.stack([low, 1e-3 * high])[None], RATE)
    np.testing.assert_allclose(band, (10.0, 300.0), atol=2.0)


def test_channel_at_its_own_place_leaves_what_it_left(rig):
    """Channels across see the modes of the second force alone."""
    misfit = LinearMisfit(rig[0])
    for channel in range(len(PLACES)):
        there = misfit.moved_to(channel, misfit.stated(channel))
        assert there == pytest.approx(misfit.chi_square, rel=1.0e-3)
