"""Campaigns on a shaker table from file to verdict: the other code hides an effect in a tube that
its base drives, and the search names it.
"""

import json

import pytest

from vibroimpact.campaign.file import read_campaign
from vibroimpact.missing_effect.engine import Engine
from vibroimpact_truth.campaign import Plan, make_campaign

LEVELS = ((0.5, 1.3, "fit"), (10.0, 1.3, "fit"), (10.0, 0.9, "holdout"))  # m/s² RMS
MASS_KG, WIDER = 0.3, 1.4


def verdict_on(config, folder, hidden):
    """verdict.json of a campaign with accelerometers on a table that moves along y."""
    plan = Plan((77, 3), hidden, levels=LEVELS, duration=12.0, on_base=True)
    make_campaign(plan, folder / "campaign.nc", twin=False)
    campaign = read_campaign(folder / "campaign.nc")
    assert campaign["force_channel_kind"].values.tolist() == ["base_acceleration"]
    Engine(config, str(folder / "campaign.nc"), folder, "quick").run({})
    return json.loads((folder / "verdict.json").read_text())


@pytest.mark.slow
def test_hidden_mass_is_weighed_on_a_table(study_config, tmp_path):
    hidden = (("added_mass", {"place": "apex", "mass": MASS_KG}),)
    verdict = verdict_on(study_config, tmp_path, hidden)
    assert (verdict["verdict"], verdict["ambiguity_set"]) == ("named", [["added_mass"]])
    mass = verdict["effects"][0]["parameters"]["mass"]
    assert mass["low"] < MASS_KG < mass["high"] and mass["high"] - mass["low"] < 0.1 * MASS_KG
    assert verdict["load_unit"] == "m/s²"


@pytest.mark.slow
def test_wider_clearance_is_named_on_a_table(study_config, tmp_path):
    """A gain common to the table and all responses is a clearance scaled, as under a force."""
    verdict = verdict_on(study_config, tmp_path, (("gap", {"factor": WIDER}),))
    assert verdict["ambiguity_set"] == [["gap"], ["sensor_gain"]]
    (gap,) = verdict["most_probable"]
    factor = gap["parameters"]["gap_factor"]
    assert gap["id"] == "gap" and factor["low"] < WIDER < factor["high"]
    assert verdict["misfit"]["holdout"]["closed_fraction"] > 0.7
    assert {"lateral_stinger", "force_misalignment"} <= set(verdict["not_testable"])
