"""A campaign on a moving base beside a model: what is refused, what is left out, and a lowest
record whose sensors are off by their gains.
"""

import numpy as np
import pytest

from tests.sound_campaign import sound_campaign
from vibroimpact.campaign.base_motion import base_motion_rows
from vibroimpact.campaign.checks.file_checks import check_campaign
from vibroimpact.campaign.file import Channel, Level, campaign_dataset, write_campaign
from vibroimpact.campaign.force_kinds import base_channels, shown_load_unit
from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.completion.own_records import Unusable, own_records
from vibroimpact.config.reading import check_config
from vibroimpact.discrepancy.power_balance import drive_channel
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.linear_stage.candidates import linear_candidates, local_candidates, not_testable
from vibroimpact.linear_stage.effect_table import held
from vibroimpact.linear_stage.workbench import Workbench, corrected_nuisance
from vibroimpact.observation.attached_model import attach
from vibroimpact.observation.comparable import comparison_problems
from vibroimpact.observation.sensor_chain import Measuring
from vibroimpact.observation.simulated_records import Forces, schedule_of, simulate_records

RATE, SECONDS, GAP = 2048.0, 16.0, 2.8886e-4
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
APEX, BEND, LEG, DRIVE = (0, 0, 1.0), (0.2121, 0, 0.9121), (-0.3, 0, 0.55), (-0.2121, 0, 0.9121)
NOWHERE = (np.nan,) * 3
CHANNELS = [
    Channel("apex a", APEX, Y, "m s-2", "acceleration"),
    Channel("bend a", BEND, Y, "m s-2", "acceleration"),
    Channel("leg a", LEG, (0.0, -1.0, 0.0), "m s-2", "acceleration"),
    Channel("apex d", APEX, Y, "m", "displacement"),
]
CARRIED = np.array([1.0, 1.0, -1.0, 0.0])  # of the base's acceleration in each channel
GAINS = np.array([1.03, 0.97, 1.02, 0.98])
TABLE = Channel("table", NOWHERE, Y, "m s-2", "base_acceleration")
FORCE = Channel("shaker", DRIVE, Y, "N", "generic")


def campaign_of(response, base, drives=(TABLE,)):
    """A campaign of one low and one high record: base (record, drive, time)."""
    levels = [Level("low", GAP), Level("high", GAP)]
    return campaign_dataset(base, response, CHANNELS, list(drives), levels, RATE, start_up="rest")


def made_up(drives=(TABLE,)):
    random = np.random.default_rng(1)
    response, base = (random.standard_normal((2, count, 4096)) for count in (4, len(drives)))
    return campaign_of(response, base * np.array([1.0, 5.0])[:, None, None], drives)


@pytest.fixture(scope="module")
def rig(study_config):
    """Workbench of the model's own records on a base, by sensors of other gains."""
    samples = int(RATE * SECONDS)
    shape = band_limited_noise(np.random.default_rng(3), samples, RATE, (5.0, 200.0))
    base = np.stack([0.3 * shape, 5.0 * shape])[:, None]
    blank = campaign_of(np.zeros((2, 4, samples)), base)
    schedule = schedule_of(blank, study_config.integration, SECONDS)
    kinds = blank["channel_kind"].values
    relative = simulate_records(
        attach(study_config, blank), schedule, Forces(base, schedule), [(0, GAP, 0)], kinds
    )[0]
    absolute = GAINS[:, None] * (relative + CARRIED[:, None] * base[0])
    noise = 0.003 * absolute.std(axis=-1, keepdims=True)
    absolute += noise * np.random.default_rng(4).standard_normal(absolute.shape)
    return Workbench(study_config, campaign_of(np.stack([absolute, absolute]), base))


def test_gains_are_told_from_the_absolute_motion(rig):
    """What a gain leaves of the base's own motion is no residual, and the gains come out."""
    fit = rig.measured_fit
    assert np.abs(fit.log_frequency).max() < 2e-4 and np.abs(fit.log_damping).max() < 0.03
    assert fit.residual.max() < 1.5 and not fit.delay.any()
    nuisance = corrected_nuisance(rig)[0]
    np.testing.assert_allclose(nuisance.gain / nuisance.gain[0], GAINS / GAINS[0], atol=0.01)


def test_a_fit_without_the_base_beside_it_leaves_more(rig):
    bench = rig.again(rig.campaign)
    bench.linear_record.base = None
    assert bench.measured_fit.residual.max() > 1.5 * rig.measured_fit.residual.max()


def test_a_gain_acts_on_the_absolute_motion(rig):
    """Simulated and measured alike: gain times absolute motion, less the motion of the base."""
    runs = rig.runs([0], 1)
    plain = rig.respond(rig.bare, runs)[0]
    faulty = rig.respond(rig.bare, runs, Measuring(GAINS, np.zeros(4)))[0]
    base = CARRIED[:, None] * rig.signals.force[0]
    expected = GAINS[:, None] * (plain + base) - base
    np.testing.assert_allclose(faulty, expected, atol=1e-5 * np.abs(expected).max())


def test_loads_are_in_metres_per_second_squared(rig):
    assert rig.signals.load_unit == shown_load_unit(rig.campaign) == "m/s²"
    assert rig.campaign["load_rms"].attrs["units"] == "m s-2"
    assert rig.signals.load[0] == pytest.approx(0.3, rel=0.01)


def test_no_force_means_no_effect_of_a_force(study_config, rig):
    assert held(rig.campaign) == []
    assert drive_channel(rig.campaign) is None
    found = {row.effect_id for row in local_candidates(rig.given, [])}
    found |= {row.effect_id for row in linear_candidates(rig.given, rig.signals.names, [], [0])}
    gone = {"lateral_stinger", "force_misalignment", "shaker_interaction"}
    assert not found & gone and {"added_mass", "gap", "sensor_gain"} <= found
    assert gone <= set(not_testable([]))
    assert "lateral_stinger" not in not_testable(["force"])


def test_force_and_base_at_once_are_refused(study_config):
    problems = comparison_problems(study_config, made_up((TABLE, FORCE)))
    (sentence,) = [text for text in problems if "beside" in text]
    assert "force_channel_kind[1] = 'force' (shaker)" in sentence
    assert "force_channel_kind[0] = 'base_acceleration' (table)" in sentence
    assert "give a campaign for each" in sentence


def test_two_tables_across_each_other_are_compared(study_config):
    """Each axis of a table drives as that axis alone does."""
    other = Channel("cross", NOWHERE, X, "m s-2", "base_acceleration")
    both = made_up((TABLE, other))
    assert comparison_problems(study_config, both) == []
    shapes = attach(study_config, both).drive_shapes
    for number, drive in enumerate((TABLE, other)):
        alone = attach(study_config, made_up((drive,))).drive_shapes
        np.testing.assert_allclose(shapes[:, [number]], alone, atol=1e-12)


def test_base_without_a_direction_is_refused(study_config):
    campaign = made_up()
    campaign["force_channel_direction"].values[:] = np.nan
    assert any(
        "table has no known direction" in row for row in comparison_problems(study_config, campaign)
    )


def test_obstacles_fixed_in_space_are_refused(study_config):
    values = study_config.model_dump(mode="json") | {"identification": None}
    values["excitation"] = {
        "kind": "base_motion",
        "direction": list(Y),
        "obstacles": "fixed",
        "signal": {"kind": "harmonic", "frequency_Hz": 20.0},
    }
    (sentence,) = comparison_problems(check_config(values, "fixed"), made_up())
    assert "obstacles: moving" in sentence


def test_structure_without_a_model_needs_a_force(tmp_path):
    campaign = sound_campaign()
    kinds = np.array(["base_acceleration"], dtype=object)
    campaign = campaign.assign(
        force_channel_kind=("force_channel", kinds),
        force_channel_units=("force_channel", np.array(["m s-2"], dtype=object)),
    )
    write_campaign(campaign, tmp_path / "campaign.nc")
    with pytest.raises(Unusable, match=r"force_channel_kind\[0\] = 'base_acceleration'"):
        own_records(tmp_path / "campaign.nc")


def test_checks_tell_what_was_taken_out():
    taken, kept = base_motion_rows(campaign_signals(made_up()))
    assert "by table is taken out of apex a, bend a, leg a" in taken["message"]
    assert kept["level"] == "warn" and "apex d are taken as relative" in kept["message"]
    checks = [row["check"] for row in check_campaign(made_up())]
    assert checks.count("base motion") == 2
    assert not list(base_motion_rows(campaign_signals(made_up((FORCE,)))))


def test_files_of_forces_are_as_they_were():
    campaign = made_up((FORCE,))
    assert "force_channel_kind" not in campaign and not base_channels(campaign).any()
    assert campaign["load_rms"].attrs["units"] == "N"
    assert "base motion" not in {row["check"] for row in check_campaign(campaign)}
