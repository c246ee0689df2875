"""Completion on three masses simulated by another integrator: modes come back, the law is named and
its parameters recovered.
"""

import functools

import numpy as np
import pytest
from scipy import linalg

from tests import joint
from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.completion.candidate import run_candidate
from vibroimpact.completion.conclude import conclude
from vibroimpact.completion.levels import levels_of
from vibroimpact.completion.linear_models import linear_errors, linear_models
from vibroimpact.completion.local_laws import LAWS
from vibroimpact.completion.mounting import mounting_table
from vibroimpact.completion.naming import leading
from vibroimpact.completion.store import modes_of, trial_of
from vibroimpact.completion.study import Study
from vibroimpact.completion.updated_model import configuration
from vibroimpact.config.reading import check_config
from vibroimpact.reduction.reduced_model import build_model

CANDIDATES = ("cubic_stiffness.joint", "single_friction.joint", "clearance.joint")
STUDY = Study(
    "joint",
    joint.BAND,
    "a1",
    (False, False),
    False,
    {"joint": {"a2": -1.0, "a3": 1.0}},
    CANDIDATES,
    (),
    mounting="joint",
    peak_Hz=(15.0, 25.0),
)
NAMED = {"cubic": "cubic_stiffness", "friction": "coulomb_friction", "clearance": "clearance"}


@functools.cache
def runs():
    """The records of every law."""
    return joint.simulate()


@functools.cache
def campaign_of(law):
    """The records of a law as a campaign, the third of four levels held out."""
    force, response = runs()[law]
    channels = [
        Channel(
            f"a{number + 1}", (float(number), 0.0, 0.0), (0.0, 0.0, 1.0), "m s-2", "acceleration"
        )
        for number in range(3)
    ]
    drive = Channel("force", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), "N", "force")
    levels = [
        Level(f"level {number + 1}", np.nan, 0, "holdout" if number == 2 else "fit")
        for number in range(len(joint.LEVELS))
    ]
    return campaign_dataset(
        force[:, None],
        response,
        channels,
        [drive],
        levels,
        joint.RATE,
        period_samples=joint.PERIOD,
        transient_periods=2,
    )


@functools.cache
def fitted(law):
    """(linear models, candidates) of a law."""
    linear = linear_models(campaign_of(law), STUDY)
    return linear, [
        run_candidate(campaign_of(law), STUDY, linear, name, told=lambda text: None)
        for name in CANDIDATES
    ]


def test_modes_of_the_lowest_level_are_those_of_the_masses():
    mass, damping, stiffness = joint.matrices()
    squares, shapes = linalg.eigh(stiffness, mass)
    modes = modes_of(fitted("clearance")[0]["base"])
    assert modes.frequency == pytest.approx(np.sqrt(squares) / (2.0 * np.pi), rel=2.0e-3)
    assert modes.damping_ratio == pytest.approx(
        np.diag(shapes.T @ damping @ shapes) / (2.0 * np.sqrt(squares)), rel=0.1
    )
    signs = np.sign(shapes[0] * modes.shapes[:, 0])
    assert modes.shapes == pytest.approx((shapes * signs).T, abs=0.03)


@pytest.mark.parametrize("law", joint.LAWS)
def test_law_is_identified_on_a_level_set_aside(law):
    linear, candidates = fitted(law)
    base = modes_of(linear["base"])
    reference = {
        level.name: linear_errors(base, level, STUDY.band_Hz)
        for level in levels_of(campaign_of(law))[0]
    }
    best, scores = leading(candidates, reference)
    assert best["ids"] == [NAMED[law]]
    assert sorted(scores.values())[-2] < scores[best["name"]] - 3.0
    (aside,) = best["tried"]
    assert np.max(best["errors"][aside]) < 0.15 < 0.5 * np.max(reference[aside])


@pytest.mark.parametrize(
    ("law", "wanted", "tolerance"),
    [
        ("cubic", {"cubic_stiffness": joint.CUBIC}, 0.05),
        ("friction", {"force": joint.SLIP, "stick_stiffness": joint.STICK}, 0.05),
        ("clearance", {"half_gap": joint.HALF_GAP, "stiffness": joint.STOP}, 0.05),
    ],
)
def test_parameters_come_back(law, wanted, tolerance):
    best = next(each for each in fitted(law)[1] if each["ids"] == [NAMED[law]])
    term = trial_of(best["trial"]).terms[0]
    found = {name: value for name, (value, _) in LAWS[term.law].summary(term.values).items()}
    assert {name: found[name] for name in wanted} == pytest.approx(wanted, rel=tolerance)


def test_verdict_names_the_joint_and_completed_model_runs():
    linear, candidates = fitted("friction")
    campaign = campaign_of("friction")
    verdict, rows, completed = conclude(
        campaign, STUDY, linear, candidates, [], told=lambda text: None
    )
    assert verdict.verdict == "named" and verdict.ambiguity_set == [["coulomb_friction"]]
    told = verdict.effects[0].parameters["force"]
    assert told.low <= joint.SLIP * 1.02 and told.high >= joint.SLIP * 0.98 and told.unit == "N"
    held = [row for row in rows if row["split"] == "holdout"]
    assert len(held) == 3 and all(
        row["error_completed"] < 0.3 * row["error_linear"] for row in held
    )
    assert verdict.misfit.holdout.closed_fraction > 0.7
    model = build_model(check_config(configuration(completed, campaign, STUDY), "updated"))
    assert model.sensor_names == (
        "a1.x",
        "a2.x",
        "a3.x",
    ) and model.local_laws.slip_limit == pytest.approx([joint.SLIP], rel=0.05)
    assert model.element_shapes[:, 0] == pytest.approx(
        model.sensor_shapes[:, 2] - model.sensor_shapes[:, 1]
    )


def test_the_equivalent_joint_softens_and_the_methods_agree():
    levels = levels_of(campaign_of("friction"))[0]
    rows, _ = mounting_table(levels, STUDY, fitted("friction")[0])
    k = {(row["level"], row["method"]): row["k_N_per_m"] for row in rows}
    for method in ("peak", "broadband"):
        changes = [k[level.name, method] for level in levels]
        # A slider that slips is softer by up to its stick stiffness.
        assert (
            changes[-1] == pytest.approx(-joint.STICK, rel=0.35) and changes[0] > 0.5 * changes[-1]
        )
