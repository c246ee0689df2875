"""Sensors of every kind in one campaign: each is compared by its own kind, in the modes of the
lowest record and in the features.
"""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.linear_stage import nuisance as linear
from vibroimpact.linear_stage.driven_channels import driven_channels
from vibroimpact.linear_stage.linear_analysis import largest_motion, mixed_up
from vibroimpact.linear_stage.mode_identification import fit_modes
from vibroimpact.linear_stage.nearest_model import BandSpectra
from vibroimpact.linear_stage.workbench import Workbench, corrected_nuisance
from vibroimpact.observation.attached_model import attach
from vibroimpact.observation.comparable import channel_rows, contact_force_rows
from vibroimpact.observation.simulated_records import Forces, schedule_of, simulate_records

RATE, SECONDS, GAP = 2048.0, 16.0, 2.8886e-4
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
APEX, BEND, LEG, PLATE = (0, 0, 1.0), (0.2121, 0, 0.9121), (-0.3, 0, 0.55), (-0.3, 0, 0.35)
UNITS = {
    "acceleration": "m s-2",
    "velocity": "mm s-1",
    "displacement": "um",
    "contact_force": "N",
}
SI = {"m s-2": 1.0, "mm s-1": 1e-3, "um": 1e-6, "N": 1.0}
CHANNELS = (
    ("apex a", APEX, Y, "acceleration"),
    ("apex v", APEX, Y, "velocity"),
    ("apex d", APEX, Y, "displacement"),
    ("bend v", BEND, Y, "velocity"),
    ("leg d", LEG, Y, "displacement"),
    ("plate y", PLATE, Y, "contact_force"),
    ("plate x", PLATE, X, "contact_force"),
)
KINDS = np.array([kind for *_, kind in CHANNELS])
MOVES = KINDS != "contact_force"
FACTORS, DAMPED = {0: 1.004, 2: 0.997}, {0: 1.1, 2: 0.9}
LATE, LATE_SAMPLES = 3, 4


def campaign_of(response, force, channels=CHANNELS):
    """A campaign of one low and one high record; response in SI."""
    described = [Channel(*row[:3], UNITS[row[3]], row[3]) for row in channels]
    scale = np.array([SI[channel.units] for channel in described])
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), Y, "N", "generic")
    levels = [Level("low", GAP), Level("high", GAP)]
    return campaign_dataset(
        force, response / scale[:, None], described, [drive], levels, RATE, start_up="rest"
    )


@pytest.fixture(scope="module")
def rig(study_config):
    """(Workbench, true response): a record of a tube whose modes and one clock are not the model's,
    with noise of one per cent in every channel.
    """
    samples = int(RATE * SECONDS)
    shape = band_limited_noise(np.random.default_rng(3), samples, RATE, (5.0, 200.0))
    force = np.stack([0.3 * shape, 5.0 * shape])[:, None]
    blank = campaign_of(np.zeros((2, len(CHANNELS), samples)), force)
    model, modes = attach(study_config, blank), np.array(sorted(FACTORS))
    told = linear.Nuisance(
        modes,
        np.array([FACTORS[mode] for mode in modes]),
        np.array([DAMPED[mode] for mode in modes]),
        np.ones(len(CHANNELS)),
    )
    schedule = schedule_of(blank, study_config.integration, SECONDS)
    true = simulate_records(
        linear.corrected(model, told), schedule, Forces(force, schedule), [(0, GAP, 0)], KINDS
    )[0]
    true[LATE] = np.roll(true[LATE], LATE_SAMPLES)
    size = np.where(MOVES, true.std(axis=-1), 10.0)  # a load cell's noise is that of its range
    noise = 0.01 * size[:, None] * np.random.default_rng(4).standard_normal(true.shape)
    response = true + noise
    return Workbench(study_config, campaign_of(np.stack([response, response]), force))


def test_modes_are_read_from_all_kinds_together(rig):
    fit = rig.measured_fit
    for mode, factor in FACTORS.items():
        place = list(fit.modes).index(mode)
        assert np.exp(fit.log_frequency[place]) == pytest.approx(factor, abs=2e-4)
        assert np.exp(fit.log_damping[place]) == pytest.approx(DAMPED[mode], abs=0.05)
    assert fit.residual[MOVES].max() < 1.5


def test_three_kinds_at_one_place_have_one_participation(rig):
    shares = rig.measured_fit.participation[:3]
    large = np.abs(shares[0]) > 0.1 * np.abs(shares[0]).max()
    np.testing.assert_allclose(shares[1:, large], shares[[0, 0]][:, large], rtol=0.01)


def test_clock_of_a_velocity_is_told_from_its_phase(rig):
    late = LATE_SAMPLES / RATE * (np.arange(5) == LATE)
    np.testing.assert_allclose(rig.measured_fit.delay[:5], late, atol=5e-5)


def test_large_delay_of_a_velocity_is_removed(rig):
    responses = rig.valid(rig.signals.response[rig.signals.lowest]).copy()
    responses[1] = np.roll(responses[1], 16)
    bench = rig.signals
    found = fit_modes(rig.linear_record, responses, rig.bare, bench.kinds, bench.noise_in_band)
    assert found.delay[1] == pytest.approx(16 / RATE, abs=5e-5)
    assert found.residual[MOVES].max() < 1.5


def test_contact_forces_take_no_part_in_the_modes(rig):
    fit = rig.measured_fit
    assert not fit.participation[~MOVES].any() and not fit.delay[~MOVES].any()
    assert (fit.residual[~MOVES] == 1.0).all()
    assert not rig.bare.sensor_shapes[:, ~MOVES].any()
    _, _, chi_square, pulls = corrected_nuisance(rig)
    assert np.isfinite(chi_square) and not pulls[-2:].any()


def test_spectra_of_the_nearest_model_in_every_kind(rig):
    """The model itself is within a decibel of its record, in units from um to m/s²."""
    assert BandSpectra(rig).distance(rig.model()) < 3.0


def test_a_contact_force_is_driven_where_its_support_is(rig):
    assert driven_channels(rig).tolist() == [True] * 6 + [False]


def test_motion_of_the_record_in_metres(rig):
    """The largest of what each kind would be at the low end of the band."""
    signals = rig.signals
    one = replace(signals, response=signals.response[:, 2:3], kinds=KINDS[2:3])
    assert largest_motion(one) == pytest.approx(np.std(signals.response[1, 2]), rel=1e-6)
    assert largest_motion(signals) >= 0.5 * largest_motion(one)


def test_no_channel_seems_swapped_or_in_another_unit(rig):
    assert mixed_up(rig) == []


def test_a_contact_force_at_no_support_is_left_out(rig, study_config):
    channels = [CHANNELS[0], ("cell", BEND, Y, "contact_force")]
    channels += [("axial", PLATE, (0.0, 0.0, 1.0), "contact_force"), CHANNELS[5]]
    force = np.random.default_rng(1).standard_normal((2, 1, 4096))
    campaign = campaign_of(np.random.default_rng(2).standard_normal((2, 4, 4096)), force, channels)
    bench = Workbench(study_config, campaign)
    signals = replace(bench.signals, noise=np.array([1.0, 1.0, 1.0, 0.0]))
    rows = contact_force_rows(bench.bare, signals)
    assert [row["channel"] for row in rows] == ["cell", "axial", "plate y"]
    assert "at no support of the model (left, right)" in rows[0]["message"]
    assert "along the tube" in rows[1]["message"]
    assert "give noise_floor_rms" in rows[2]["message"]
    assert channel_rows(campaign) == []
