"""A campaign against a user's matrices, from file to verdict: the other code hides what is missing
in the structure that the matrices describe.
"""

import json

import numpy as np
import pytest

from tests import own_matrices
from vibroimpact.campaign.file import read_campaign, write_campaign
from vibroimpact.linear_stage.linear_analysis import prepare
from vibroimpact.missing_effect.engine import Engine

MASS_KG = 0.15


def verdict_of(folder, path):
    """The verdict of a campaign file."""
    config = own_matrices.checked(own_matrices.model_values(folder), folder)
    Engine(config, str(path), folder, "quick").run({})
    return json.loads((folder / "verdict.json").read_text())


@pytest.mark.slow
def test_matrices_that_lack_nothing_are_told_so(tmp_path):
    verdict = verdict_of(tmp_path, own_matrices.campaign_file(tmp_path))
    assert (verdict["verdict"], verdict["effects"]) == ("none", [])
    assert not [row for row in verdict["checks"] if row["level"] == "warn"]


@pytest.mark.slow
def test_mass_hidden_in_matrices_is_weighed_at_its_point(tmp_path):
    hidden = (("added_mass", {"place": 0.85, "mass": MASS_KG}),)
    verdict = verdict_of(tmp_path, own_matrices.campaign_file(tmp_path, hidden))
    assert (verdict["verdict"], verdict["ambiguity_set"]) == ("named", [["added_mass"]])
    (effect,) = verdict["effects"]
    mass = effect["parameters"]["mass"]
    assert effect["location"] == "n17" and mass["low"] < MASS_KG < mass["high"]
    assert verdict["misfit"]["holdout"]["closed_fraction"] > 0.8


@pytest.mark.slow
def test_wider_stop_of_matrices_is_named(tmp_path):
    hidden = (("gap", {"factor": 1.7, "plates": "all"}),)
    verdict = verdict_of(tmp_path, own_matrices.campaign_file(tmp_path, hidden))
    assert verdict["ambiguity_set"] == [["gap"], ["sensor_gain"]]  # no record tells them apart
    assert verdict["misfit"]["holdout"]["closed_fraction"] > 0.8


@pytest.mark.slow
def test_channel_at_another_point_is_found(tmp_path):
    path = own_matrices.campaign_file(tmp_path)
    campaign = read_campaign(path)
    points = campaign["channel_point"].values.copy()
    points[1] = [0.0, 0.0, 0.8]  # it is at 0.6
    moved = campaign.assign(channel_point=(campaign["channel_point"].dims, points))
    write_campaign(moved, tmp_path / "moved.nc")
    config = own_matrices.checked(own_matrices.model_values(tmp_path), tmp_path)
    checks = prepare(config, tmp_path / "moved.nc").checks
    (row,) = [row for row in checks if row["check"] == "linear model"]
    assert row["level"] == "warn" and "the place of s2" in row["message"]
    assert str(np.array([0.0, 0.0, 0.6]).tolist()) in row["message"]
