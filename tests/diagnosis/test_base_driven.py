"""A campaign on a moving base beside a model: what is refused and what is left out."""

import numpy as np
import pytest

from tests.support.sound_campaign import sound_campaign
from vibroimpact.campaign.base_motion import base_motion_rows
from vibroimpact.campaign.checks.file_checks import check_campaign
from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.campaign.force_kinds import base_channels, shown_load_unit
from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.identified.records import usable_records
from vibroimpact.diagnosis.measurement.attached_model import attach
from vibroimpact.diagnosis.measurement.comparable import comparison_problems
from vibroimpact.diagnosis.measurement.signals import signals_of
from vibroimpact.diagnosis.measurement.usable import Refused, not_testable

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


def test_loads_are_in_metres_per_second_squared():
    campaign = made_up()
    assert signals_of(campaign).load_unit == shown_load_unit(campaign) == "m/s²"
    assert campaign["load_rms"].attrs["units"] == "m s-2"


def test_no_force_means_no_effect_of_a_force():
    gone = {"lateral_stinger", "force_misalignment", "shaker_interaction"}
    assert gone <= set(not_testable(made_up()))
    assert "lateral_stinger" not in not_testable(made_up((FORCE,)))


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


def test_structure_without_a_model_needs_a_force():
    campaign = sound_campaign()
    kinds = np.array(["base_acceleration"], dtype=object)
    campaign = campaign.assign(
        force_channel_kind=("force_channel", kinds),
        force_channel_units=("force_channel", np.array(["m s-2"], dtype=object)),
    )
    with pytest.raises(Refused, match=r"force_channel_kind\[0\] = 'base_acceleration'"):
        usable_records(campaign)


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
