"""A campaign of a laser vibrometer and two load cells from file to verdict: the other code hides a
mass in a tube, and the search names it and weighs it.
"""

import json

import numpy as np
import pytest
from scipy.signal import resample_poly

from vibroimpact.campaign.file import read_campaign, write_campaign
from vibroimpact.missing_effect.engine import Engine
from vibroimpact_truth.campaign import Plan, make_campaign

MASS_KG, NOISE = 0.3, 0.01
LEVELS = ((0.5, 1.3, "fit"), (10.0, 1.3, "fit"), (10.0, 0.9, "holdout"))
RECORDED_S = 12.0
FINER = 8  # samples of the integral per sample of the record: 0.05 % at 200 Hz


def velocities(acceleration, rate):
    """(..., time) of accelerations (..., time) from rest, by the trapezoidal rule."""
    fine = resample_poly(acceleration, FINER, 1, axis=-1)
    steps = np.cumsum(0.5 * (fine[..., 1:] + fine[..., :-1]), axis=-1) / (FINER * rate)
    return np.concatenate([0.0 * fine[..., :1], steps], axis=-1)[..., ::FINER]


def as_a_vibrometer(campaign):
    """The campaign with a velocity in place of every acceleration, and with noise."""
    kinds, units = (campaign[f"channel_{key}"].values.copy() for key in ("kind", "units"))
    moves, response = kinds == "acceleration", campaign["response"].values.astype(float)
    response[:, moves] = velocities(response[:, moves], campaign.attrs["sampling_frequency"])
    kinds[moves], units[moves] = "velocity", "m s-1"
    rms = np.sqrt(np.mean(response**2, axis=-1))
    noise = NOISE * np.where(moves, rms[0, moves].max(), rms.max(axis=0))
    response += noise[:, None] * np.random.default_rng(8).standard_normal(response.shape)
    return campaign.assign(
        response=(campaign["response"].dims, response.astype(np.float32)),
        channel_kind=("channel", kinds),
        channel_units=("channel", units),
    )


@pytest.mark.slow
def test_hidden_mass_is_weighed_by_a_vibrometer(study_config, tmp_path):
    hidden = (("added_mass", {"place": "apex", "mass": MASS_KG}),)
    plan = Plan((77, 3), hidden, levels=LEVELS, duration=RECORDED_S, noise=0.0, contact_force=True)
    make_campaign(plan, tmp_path / "made.nc", twin=False)
    campaign = as_a_vibrometer(read_campaign(tmp_path / "made.nc"))
    assert set(campaign["channel_kind"].values) == {"velocity", "contact_force"}
    write_campaign(campaign, tmp_path / "campaign.nc")

    Engine(study_config, str(tmp_path / "campaign.nc"), tmp_path, "quick").run({})

    verdict = json.loads((tmp_path / "verdict.json").read_text())
    assert not [row for row in verdict["checks"] if row["check"] == "channels"]
    assert (verdict["verdict"], verdict["ambiguity_set"]) == ("named", [["added_mass"]])
    (effect,) = verdict["effects"]
    mass = effect["parameters"]["mass"]
    assert effect["location"] == "apex" and mass["low"] < MASS_KG < mass["high"]
    assert mass["high"] - mass["low"] < 0.05 * MASS_KG
    assert verdict["p_global_before"] < 1.0e-6 < 0.05 < verdict["p_global_after"]
