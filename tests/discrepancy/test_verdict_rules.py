"""The verdict from scores: who is named, who is not told apart, when a pair is needed, and when
nobody is named.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import by_level as levels
from vibroimpact.discrepancy import naming, verdict
from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.misfit import closed_fraction
from vibroimpact.effects.places import STOP

THRESHOLD, EXPLAINED, LEFT = 15.0, np.array([0.3, -1.0]), np.array([0.3, -9.0])
SCALES = {"gap": 2.0e-4, "one": 1.0, "contact_stiffness": 4.0e6, "hertz": 2.0e8}


def finalist(name, gain, explained=EXPLAINED, held_out=10.0, part=0.0):
    """A Finalist of a name as the verdict sees it; part: what the better of a pair's effects
    explains alone.
    """
    candidate = candidate_named(name)
    count = len(candidate.effect.parameters)
    interval = np.tile([0.75, 0.85], (count, 1))
    return SimpleNamespace(
        candidate=candidate,
        mean=name,
        gain=gain,
        left=explained,
        held_out=held_out,
        interval=interval,
        unit=interval.mean(axis=1),
        total=gain,
        parts=np.array([0.0, part]),
        own=lambda null: null,
    )


@pytest.fixture
def decided(monkeypatch):
    """Return the function (finalists, adopted, rest, p, share, linear, beyond) -> Decision."""

    def run(found, adopted=None, rest=LEFT, p=1.0e-6, share=0.9, linear=(), beyond=100.0):
        left = {row.mean: row.left for row in found} | {"null": rest}
        monkeypatch.setattr(
            verdict.naming,
            "totals",
            lambda *_: {
                row.candidate.name: (row.gain, row.gain - row.held_out, row.held_out)
                for row in found
            },
        )
        monkeypatch.setattr(verdict.naming, "explained", lambda bench, null, mean, *_: left[mean])
        monkeypatch.setattr(verdict.naming, "bare_explained", lambda *_: left["null"])
        monkeypatch.setattr(verdict, "closure", lambda *_: share)
        monkeypatch.setattr(verdict, "beyond_chance", lambda *_: beyond)
        bench = SimpleNamespace(measured_features={"records": None})
        prepared = SimpleNamespace(adopted=adopted, linear=list(linear), scales=SCALES)
        order = sorted(found, key=lambda row: -row.gain)
        return verdict.decide(
            bench, SimpleNamespace(records="records", mean="null"), prepared, order, THRESHOLD, p
        )

    return run


def test_no_discrepancy_gives_verdict_none(decided):
    assert decided([], rest=EXPLAINED, p=0.6).verdict == "none"
    assert decided([finalist("hertz@all", 9.0)], rest=EXPLAINED, p=0.6).verdict == "none"


def test_unexplained_discrepancy_is_unknown(decided):
    assert decided([finalist("hertz@all", 9.0)]).verdict == "unknown"


def test_clear_best_effect_is_named_alone(decided):
    found = decided([finalist("plate_flexibility@all", 300.0), finalist("dry_friction@all", 200.0)])
    assert (found.verdict, found.ambiguity) == ("named", [["plate_flexibility"]])


def test_close_effects_and_gaps_form_ambiguity_sets(decided):
    near = decided([finalist("dry_friction@all", 300.0), finalist("foliate_obstacle@all", 295.0)])
    assert (near.verdict, near.ambiguity) == ("ambiguous", [["dry_friction"], ["foliate_obstacle"]])
    assert decided([finalist("gap@all", 300.0)]).ambiguity == [["gap"], ["sensor_gain"]]


def test_sufficient_alias_stays_in_the_set(decided):
    both = decided([finalist("contact_damping@all", 1200.0), finalist("hunt_crossley@all", 1000.0)])
    assert both.ambiguity == [["contact_damping"], ["hunt_crossley"]]
    assert decided(
        [finalist("contact_damping@all", 1200.0), finalist("hunt_crossley@all", 800.0, LEFT)]
    ).ambiguity == [["contact_damping"]]
    assert decided(
        [finalist("hertz@all", 1200.0), finalist("contact_stiffness@all", 950.0, LEFT)]
    ).ambiguity == [["hertz"], ["contact_stiffness"]]


def test_pair_needs_two_contributing_effects(decided):
    single, pair = finalist("gap@left", 300.0, LEFT), finalist("gap@left+dry_friction@all", 400.0)
    assert decided([single, pair]).ambiguity == [["dry_friction", "gap"]]
    assert decided([finalist("gap@left", 300.0), pair]).ambiguity == [["gap"]]
    insufficient = decided([single, finalist("gap@left+dry_friction@all", 400.0, LEFT)])
    assert (insufficient.verdict, insufficient.ambiguity) == (
        "partly_explained",
        [["dry_friction", "gap"], ["gap"]],
    )
    little = decided([single, finalist("gap@left+dry_friction@all", 325.0)])
    assert (little.verdict, little.ambiguity) == (
        "partly_explained",
        [["gap"], ["dry_friction", "gap"]],
    ) and little.chosen is single
    idle = finalist("gap@left+dry_friction@all", 400.0, part=390.0)
    assert decided([single, idle]).chosen is single


def test_large_residual_is_partly_explained_or_unknown(decided):
    single = [finalist("gap@all", 300.0, LEFT)]
    assert decided(single, share=0.7).verdict == "partly_explained"
    unknown = decided(single, share=0.3)
    assert (unknown.verdict, unknown.chosen, unknown.ambiguity) == ("unknown", None, [])


def test_loss_on_held_out_records_vetoes_an_effect(decided):
    assert decided([finalist("hertz@all", 300.0, held_out=-40.0)], share=0.3).verdict == "unknown"


def test_linear_and_contact_effects_are_named_together(decided):
    adopted = {"name": "added_mass@apex", "unit": [0.4], "gain": 90.0}
    rows = [
        adopted,
        {"name": "mode_frequency_error@mode_1", "gain": 85.0},
        {"name": "root_stiffness@roots", "gain": 40.0},
    ]
    alone = decided([], adopted=adopted, rest=EXPLAINED, linear=rows)
    assert (alone.verdict, alone.ambiguity) == (
        "ambiguous",
        [["added_mass"], ["mode_frequency_error"]],
    )
    both = decided([finalist("dry_friction@all", 300.0)], adopted=adopted, linear=rows[:1])
    assert both.ambiguity == [["added_mass", "dry_friction"]]


def test_two_linear_effects_form_one_set(decided):
    adopted = {
        "name": "added_mass@apex+sensor_gain@apex_y",
        "unit": [0.4, 0.6],
        "gain": 90.0,
        "interval": [[0.39, 0.41], [0.55, 0.65]],
    }
    rows = [
        adopted,
        {"name": "added_mass@apex+modal_damping@all", "gain": 88.0},
        {"name": "added_mass@apex", "gain": 40.0},
    ]
    alone = decided([], adopted=adopted, rest=EXPLAINED, linear=rows)
    assert (alone.verdict, alone.ambiguity) == (
        "ambiguous",
        [["added_mass", "sensor_gain"], ["added_mass", "modal_damping"]],
    )
    beside = decided([finalist("dry_friction@all", 300.0)], adopted=adopted, linear=rows[:1])
    assert beside.ambiguity == [["added_mass", "dry_friction", "sensor_gain"]]
    told = verdict.effects_of(
        SimpleNamespace(adopted=adopted, scales=SCALES | {"mass": 1.0}), alone, None
    )
    assert [(row["id"], row["location"], list(row["parameters"])) for row in told] == [
        ("added_mass", "apex", ["mass"]),
        ("sensor_gain", "apex_y", ["factor"]),
    ]
    gain = told[1]["parameters"]["factor"]
    assert gain["value"] == pytest.approx(0.25 * 16.0**0.6)
    assert gain["low"] < gain["value"] < gain["high"]


@pytest.mark.parametrize(
    ("location", "nominal"), [("left", 3.0e-4), ("right", 5.0e-4), ("all", None)]
)
def test_gap_is_given_in_metres_of_the_model_clearance(decided, location, nominal):
    laws = SimpleNamespace(gap=np.array([np.nan, np.nan, 5.0e-4, 9.0e-4]))
    model = SimpleNamespace(
        support_names=("left", "right", STOP),
        support_of_point=np.array([0, 0, 1, 2]),
        gap_factor=np.array([1.5, 1.5, 1.0, 1.0]),
        contact_laws=laws,
    )
    decision = decided([finalist(f"gap@{location}", 300.0)])
    (row,) = verdict.effects_of(SimpleNamespace(adopted=None, scales=SCALES), decision, model)
    factor = row["parameters"]["gap_factor"]["value"]
    assert ("gap" in row["parameters"]) == (nominal is not None)
    if nominal is not None:
        assert row["parameters"]["gap"]["value"] == pytest.approx(nominal * factor)


def test_nonlinear_effect_replaces_the_linear_one(
    decided,
):
    adopted = {"name": "fluid_added_mass_damping@tube", "unit": [0.1, 0.2], "gain": 40.0}
    beside = finalist("quadratic_drag@tube", 310.0)
    alone = finalist("quadratic_drag@tube@alone", 304.0)
    both = decided([beside, alone], adopted=adopted, linear=[adopted])
    assert (both.verdict, both.ambiguity, both.chosen) == ("named", [["quadratic_drag"]], alone)
    worse = decided(
        [beside, finalist("quadratic_drag@tube@alone", 280.0)], adopted=adopted, linear=[adopted]
    )
    assert worse.ambiguity == [["fluid_added_mass_damping", "quadratic_drag"]]


def test_parameter_is_estimated_level_by_level(monkeypatch):
    fitted = iter([0.5, 0.25])
    monkeypatch.setattr(
        levels,
        "calibrate",
        lambda *_: SimpleNamespace(unit=np.array([next(fitted)]), interval=np.array([[0.2, 0.7]])),
    )
    signals = SimpleNamespace(load=np.array([0.5, 3.0, 10.0]), gap=np.full(3, 2.0e-4))
    (row,) = levels.by_level(
        SimpleNamespace(signals=signals),
        SimpleNamespace(records=np.array([1, 2])),
        np.zeros((2, 4)),
        SimpleNamespace(
            candidate=candidate_named("dry_friction@all"), path=None, own=lambda null: null
        ),
        SCALES,
    )
    assert (row["parameter"], row["load_rms_N"]) == ("mu", [3.0, 10.0])
    np.testing.assert_allclose(
        [row["value"], row["low"], row["high"]],
        [[0.1, 100**0.25 / 100], [100**0.2 / 100] * 2, [100**0.7 / 100] * 2],
    )
    pair = SimpleNamespace(candidate=candidate_named("dry_friction@all+gap@all"), path=None)
    assert levels.by_level(None, None, np.zeros((2, 4)), pair, SCALES) == []


def test_estimate_allows_for_a_common_gain():
    """Lengths and forces are known no better than such a gain: 2 %, one sigma; a friction
    coefficient is.
    """
    gap, friction = candidate_named("gap@all"), candidate_named("dry_friction@all")
    unit = np.array([0.5])
    value, low, high = gap.estimate(unit, np.array([[0.5, 0.5]]), {"one": 1.0})["gap_factor"]
    assert (value / low, high / value) == pytest.approx(
        (1.0 / (1.0 - 1.645 * 0.02), 1.0 + 1.645 * 0.02)
    )
    mu, narrow, _ = friction.estimate(unit, np.array([[0.49, 0.51]]), {"one": 1.0})["mu"]
    assert narrow == pytest.approx(friction.physical([0.49], {"one": 1.0})["mu"]) and narrow < mu


def test_linear_effect_stays_when_the_rest_is_unexplained(decided):
    adopted = {"name": "sensor_gain@apex_y", "gain": 400.0, "unit": [0.7]}
    found = decided(
        [finalist("lateral_stinger@along_x", 30.0, explained=LEFT)],
        adopted=adopted,
        share=-0.2,
        linear=[adopted],
    )
    assert (found.verdict, found.ambiguity, found.chosen) == (
        "partly_explained",
        [["sensor_gain"]],
        None,
    )


def test_contradicted_effect_is_not_named(decided):
    """A gain on the fitted records alone, where the bare model is within the scatter of its
    seeds.
    """
    overfit = [finalist("hunt_crossley@all", 18.0, held_out=-20.0)]
    assert decided(overfit, rest=EXPLAINED, p=0.4).verdict == "none"
    adopted = {"name": "sensor_gain@force", "gain": 52.0, "unit": [0.53]}
    assert decided(overfit, adopted=adopted, rest=EXPLAINED, linear=[adopted]).ambiguity == [
        ["sensor_gain"]
    ]


@pytest.mark.parametrize(
    ("held_out", "expected"),
    [(85.0, [["contact_damping", "modal_damping"]]), (THRESHOLD - 1.0, [["modal_damping"]])],
)
def test_held_out_records_alone_may_name_an_effect(decided, held_out, expected):
    """Contact damping beside modal damping: 305 units of which 85 on the held-out record, within
    what the null's covariance holds.
    """
    adopted = {"name": "modal_damping@all", "unit": [0.9], "gain": 1000.0}
    found = decided(
        [finalist("contact_damping@all", 305.0, held_out=held_out)],
        adopted=adopted,
        rest=EXPLAINED,
        p=0.98,
        share=0.0,
        beyond=-10.0,
    )
    assert (found.verdict, found.ambiguity) == ("named", expected)


def test_contradicted_effect_is_not_added_to_a_linear_one(decided):
    """Though the model still misses something: a loss beyond what tells candidates apart is none of
    chance.
    """
    adopted = {"name": "modal_damping@all", "gain": 125.0, "unit": [0.66]}
    lost, kept = (
        decided(
            [finalist("quadratic_stiffness@left_leg", 28.0, held_out=held_out)],
            adopted=adopted,
            linear=[adopted],
        )
        for held_out in (-13.0, -5.0)
    )
    assert (lost.verdict, lost.ambiguity, lost.chosen) == (
        "partly_explained",
        [["modal_damping"]],
        None,
    )
    assert (kept.verdict, kept.ambiguity) == ("named", [["modal_damping", "quadratic_stiffness"]])


def split(before, after, floor=1.0):
    """A misfit of one split."""
    return {
        "before_dB": before,
        "after_dB": after,
        "floor_dB": floor,
        "closed_fraction": closed_fraction(before, after, floor),
    }


NOTHING = {"before_dB": None, "after_dB": None, "floor_dB": None, "closed_fraction": None}


def test_effect_worsening_held_out_records_is_refuted(decided):
    """Whatever it closes of the fitted ones: a damping of 1000 N s/m per plate was read as 1291 and
    brought the others from 8.9 to 10.5 dB.
    """
    part = decided([finalist("gap@all", 300.0, LEFT)], share=0.7)
    named = decided([finalist("gap@all", 300.0)])
    fitted = split(9.0, 2.0)
    for decision in (part, named):
        assert verdict.refuted(decision, {"fit": fitted, "holdout": split(8.9, 10.5)})
        assert not verdict.refuted(decision, {"fit": fitted, "holdout": split(8.9, 6.0)})
        assert not verdict.refuted(decision, {"fit": fitted, "holdout": NOTHING})
    # both at the floor: a difference of chance
    assert not verdict.refuted(named, {"fit": fitted, "holdout": split(1.03, 1.07)})


def test_partial_effect_improving_no_record_is_refuted(decided):
    """Likelihood may gain by co and quad and kurtosis where no band's power comes nearer."""
    part = decided([finalist("gap@all", 300.0, LEFT)], share=0.7)
    near, much = split(5.0, 4.9), split(5.0, 2.5)
    assert verdict.refuted(part, {"fit": near, "holdout": near})
    assert verdict.refuted(part, {"fit": near, "holdout": NOTHING})
    assert not verdict.refuted(part, {"fit": NOTHING, "holdout": NOTHING})
    assert not verdict.refuted(part, {"fit": much, "holdout": near})
    assert not verdict.refuted(part, {"fit": near, "holdout": much})


def screened(**scores):
    """[Screened] best first of {effect at location: score}, locations after two underscores."""
    rows = [
        naming.Screened(candidate_named(name.replace("__", "@")), score, np.zeros(1))
        for name, score in scores.items()
    ]
    return sorted(rows, key=lambda row: -row.score)


def names(rows):
    return [row.candidate.name for row in rows]


def test_each_effect_and_aliases_of_the_best_are_refined_once():
    rows = screened(
        clearance__apex=100.0,
        coulomb_friction__shaker=90.0,
        cubic_stiffness__apex=35.0,
        clearance__shaker=80.0,
        cubic_stiffness__shaker=30.0,
        hertz__all=70.0,
        preload__all=20.0,
    )
    assert names(naming.finalists(rows, LEFT)) == [
        "clearance@apex",
        "coulomb_friction@shaker",
        "hertz@all",
        "cubic_stiffness@apex",
    ]


def test_nothing_is_refined_without_discrepancy_or_gain():
    rows = screened(hertz__all=4.0, gap__all=-3.0)
    assert names(naming.finalists(rows, EXPLAINED)) == []
    assert names(naming.finalists(rows, LEFT)) == ["hertz@all"]
    assert names(naming.finalists(screened(hertz__all=6.0), EXPLAINED)) == ["hertz@all"]


def test_candidates_of_a_bank_are_refined_at_any_score():
    """Contact damping beside nine times the damping of all modes, which the candidates of a bank do
    not have: -64 there, 275 in the campaign.
    """
    rows = screened(
        contact_damping__all=-64.0,
        hertz__all=-77.0,
        contact_stiffness__all=-79.0,
        quadratic_stiffness__left_leg=-82.0,
        hunt_crossley__all=-92.0,
    )
    assert names(naming.finalists(rows, EXPLAINED, elsewhere=True)) == [
        "contact_damping@all",
        "hertz@all",
        "contact_stiffness@all",
        "hunt_crossley@all",
    ]
    assert names(naming.finalists(rows, EXPLAINED)) == []
