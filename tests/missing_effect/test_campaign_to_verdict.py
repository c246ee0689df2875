"""One campaign from file to verdict: the other code hides a damper in the plates of a tube."""

import json

import pytest

from vibroimpact.missing_effect.engine import Engine
from vibroimpact_truth.campaign import Plan, make_campaign

DAMPING = 900.0  # N s/m of every plate, beyond what the steps of the model take
LEVELS = ((0.5, 1.3, "fit"), (4.0, 1.3, "fit"), (12.0, 1.3, "fit"), (10.0, 0.9, "holdout"))
RECORDED_S = 12.0


@pytest.mark.slow
def test_hidden_contact_damping_is_named_and_sized(study_config, tmp_path):
    hidden = (("contact_damping", {"damping": DAMPING}),)
    plan = Plan((77, 11), hidden, levels=LEVELS, duration=RECORDED_S)
    make_campaign(plan, tmp_path / "campaign.nc", twin=False)
    Engine(study_config, str(tmp_path / "campaign.nc"), tmp_path, "quick").run({})

    verdict = json.loads((tmp_path / "verdict.json").read_text())
    assert ["contact_damping"] in verdict["ambiguity_set"]
    (row,) = [row for row in verdict["ranking"] if row["ids"] == ["contact_damping"]][:1]
    assert row["probability"] > 0.5
    effect = verdict["most_probable"][0]
    assert effect["id"] in ("contact_damping", "hunt_crossley")
    if effect["id"] == "contact_damping":
        size = effect["parameters"]["damping"]
        assert size["low"] < DAMPING < size["high"]
    held_out = verdict["misfit"]["holdout"]
    assert held_out["after_dB"] < 0.5 * held_out["before_dB"]
    stages = verdict["cost"]["by_stage"]
    assert stages["screening"]["simulations"] > stages["null"]["simulations"] > 0
    so_far = json.loads((tmp_path / "so_far.json").read_text())
    assert so_far["probability_by_chance"] < 0.01 and so_far["where"]
