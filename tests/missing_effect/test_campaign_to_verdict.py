"""One campaign from file to verdict: the other code hides a damper in the plates of a tube."""

import json

import pytest

from vibroimpact.missing_effect.engine import Engine
from vibroimpact_truth.campaign import Plan, make_campaign

DAMPING = 900.0  # N s/m of every plate, more than the usual steps take
LEVELS = ((0.5, 1.3, "fit"), (4.0, 1.3, "fit"), (12.0, 1.3, "fit"), (10.0, 0.9, "holdout"))
RECORDED_S = 12.0


@pytest.mark.slow
def test_family_of_a_hidden_contact_damping_is_named(study_config, tmp_path):
    hidden = (("contact_damping", {"damping": DAMPING}),)
    plan = Plan((77, 11), hidden, levels=LEVELS, duration=RECORDED_S)
    make_campaign(plan, tmp_path / "campaign.nc", twin=False)
    Engine(study_config, str(tmp_path / "campaign.nc"), tmp_path, "quick").run({})

    verdict = json.loads((tmp_path / "verdict.json").read_text())
    # the quick search does not tell two laws of contact damping apart
    laws = {"contact_damping", "hunt_crossley"}
    assert verdict["verdict"] in ("named", "ambiguous")
    assert {effect for ids in verdict["ambiguity_set"] for effect in ids} <= laws
    assert {effect["id"] for effect in verdict["most_probable"]} <= laws
    assert verdict["misfit"]["holdout"]["closed_fraction"] > 0.5
    stages = verdict["cost"]["by_stage"]
    assert stages["screening"]["simulations"] > stages["null"]["simulations"] > 0
    so_far = json.loads((tmp_path / "so_far.json").read_text())
    assert so_far["probability_by_chance"] < 0.01 and so_far["where"]
