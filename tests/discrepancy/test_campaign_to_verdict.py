"""One campaign from file to verdict: the other code hides a mass in a tube, and the search names it
and weighs it.
"""

import json

from vibroimpact.discrepancy.priors import SIGNIFICANT
from vibroimpact.discrepancy.whole import run_campaign
from vibroimpact.effects.registry import EFFECTS
from vibroimpact_truth.campaign import Plan, make_campaign

MASS_KG = 0.3
# Short records of few levels, a coarse model and few effects: what a full search takes minutes for.
LEVELS = ((0.5, 1.3, "fit"), (10.0, 1.3, "fit"), (10.0, 0.9, "holdout"))
RECORDED_S, COMPARED_S = 8.0, 6.0
COARSE = {"free_modes_to_Hz": 2000.0, "constrained_modes_to_Hz": 500.0, "attachment_shapes": True}
CATALOGUE = {"added_mass", "modal_damping", "gap", "contact_damping"}


def test_hidden_mass_is_named_and_weighed(study_config, tmp_path):
    hidden = (("added_mass", {"place": "apex", "mass": MASS_KG}),)
    plan = Plan((77, 3), hidden, levels=LEVELS, duration=RECORDED_S)
    make_campaign(plan, tmp_path / "campaign.nc", twin=False)

    values = study_config.model_dump(mode="json") | {"basis": COARSE}
    values["structure"]["mesh"] = {"elements_per_span": 8, "elements_per_bend": 24}
    run_campaign(
        values,
        tmp_path / "campaign.nc",
        tmp_path,
        {},
        longest_s=COMPARED_S,
        quick=True,
        without=frozenset(EFFECTS) - CATALOGUE,
    )

    verdict = json.loads((tmp_path / "verdict.json").read_text())
    assert (verdict["verdict"], verdict["ambiguity_set"]) == ("named", [["added_mass"]])
    (effect,) = verdict["effects"]
    assert effect["location"] == "apex"
    mass = effect["parameters"]["mass"]
    assert mass["unit"] == "kg" and mass["low"] < MASS_KG < mass["high"]
    assert mass["high"] - mass["low"] < 0.05 * MASS_KG
    assert verdict["p_global_before"] < 1.0e-6 < SIGNIFICANT < verdict["p_global_after"]
