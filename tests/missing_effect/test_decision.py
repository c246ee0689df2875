"""From probabilities to a verdict."""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.missing_effect.decision import (
    decide,
    exactly_alike,
    partly_decision,
    smallest,
    something_else,
    withdrawn_decision,
)
from vibroimpact.missing_effect.evidence import Fit
from vibroimpact.missing_effect.verification import Closing

MASS, FRICTION, DAMPING, CROSSLEY = (
    "added_mass@apex",
    "dry_friction@all",
    "contact_damping@all",
    "hunt_crossley@all",
)


ESTIMATE = np.array([0.5]), np.array([[0.4, 0.6]])


def fit_at(laws=(0.0, -9.0, -9.0)):
    samples = np.linspace(0.0, 1.0, 101)[:, None]
    return Fit(
        promised=50.0,
        by_law=np.array(laws),
        unit=np.array([0.5]),
        samples=samples,
        weight=np.full(101, 1 / 101),
        open_weight=np.full(101, 1 / 101),
        density=np.ones(101),
        mean=np.zeros(9),
        left=9.0,
        not_shown=0.0,
        takes=0.0,
        may_take=0.0,
        doubt=0.0,
    )


def decided(linear=(), fits=None, families=None, **chances):
    names = {"friction": FRICTION, "damping": DAMPING, "crossley": CROSSLEY}
    chances = {
        names.get(name.removesuffix("_beside"), name.replace("_", " "))
        + "+?" * name.endswith("_beside"): np.log(chance)
        for name, chance in chances.items()
    }
    known = {name: fit_at() for name in names.values()} | (fits or {})
    return decide(
        chances,
        known,
        lambda _: ESTIMATE,
        list(linear),
        before=90.0,
        values=9,
        families=families or {},
    )


def test_one_explanation_above_nine_in_ten_is_named():
    found = decided(nothing=0.01, something_else=0.02, friction=0.95, damping=0.02)
    assert (found.verdict, found.ambiguity) == ("named", [["dry_friction"]])
    assert found.probabilities == pytest.approx([0.95])
    assert found.chosen.candidate.name == FRICTION and found.chosen.law_fits


def test_laws_that_share_the_probability_are_ambiguous():
    found = decided(nothing=0.01, something_else=0.02, damping=0.55, crossley=0.42)
    assert found.verdict == "ambiguous"
    assert found.ambiguity == [["contact_damping"], ["hunt_crossley"]]
    assert sum(found.probabilities) >= 0.9


def test_family_is_named_where_none_of_its_laws_fits():
    chances = {"nothing": 0.01, "something_else": 0.94, "damping": 0.05, "friction": 0.01}
    families = {"friction": 0.97, "contact damping": 0.03}
    found = decided(**chances, families=families)
    assert (found.verdict, found.ambiguity) == ("partly_explained", [["dry_friction"]])
    assert found.family_alone and not found.chosen.law_fits
    assert found.probabilities == [0.97] == [found.chosen.probability]
    nearer = {FRICTION: replace(fit_at(), left=95.0)}  # no run of it is nearer than nothing
    assert decided(**chances, families=families, fits=nearer).verdict == "unknown"
    assert decided(**chances, families={"friction": 0.6, "drag": 0.4}).verdict == "unknown"


def test_nothing_and_something_else_name_nothing():
    none = decided(nothing=0.9, something_else=0.05, friction=0.05)
    unknown = decided(nothing=0.01, something_else=0.94, friction=0.05)
    assert (none.verdict, none.ambiguity, none.chosen) == ("none", [], None)
    assert (unknown.verdict, unknown.ambiguity, unknown.chosen) == ("unknown", [], None)


def test_nothing_is_missing_where_all_else_is_refuted():
    chances = {"nothing": 0.42, "something_else": 1.0e-9, "friction": 0.57, "damping": 0.01}
    found = withdrawn_decision(decided(**chances))
    assert (found.verdict, found.chosen, found.ambiguity) == ("none", None, [])
    assert [row[0] for row in found.rows] == [DAMPING]
    together = found.nothing + found.something_else + sum(row[1] for row in found.rows)
    assert together == pytest.approx(1.0) and found.nothing == pytest.approx(0.42 / 0.43)


def test_what_is_left_of_the_refuted_is_unknown():
    for nothing, other in ((1.0e-30, 1.0e-20), (0.0, 0.0), (0.1, 0.2)):
        found = decided(nothing=nothing + 1e-300, something_else=other + 1e-300, friction=0.7)
        assert withdrawn_decision(found).verdict == "unknown"


def test_model_of_another_structure_names_nothing():
    none = something_else(decided(nothing=0.9, something_else=0.05, friction=0.05))
    assert (none.verdict, none.nothing, none.something_else) == ("unknown", 0.0, 1.0)


def test_family_is_named_where_its_law_leaves_something():
    found = decided(nothing=0.001, something_else=0.019, friction=0.02, friction_beside=0.96)
    assert found.verdict == "named" and not found.chosen.law_fits
    other = decided(
        fits={FRICTION: fit_at((-9.0, -9.0, 0.0))},
        nothing=0.001,
        something_else=0.019,
        friction=0.98,
    )
    assert other.verdict == "named" and not other.chosen.law_fits


def test_explanation_that_leaves_much_is_a_part_of_one():
    part = replace(fit_at(), left=50.0)  # of 90, where chance leaves 9
    found = decided(fits={FRICTION: part}, nothing=0.001, something_else=0.019, friction=0.98)
    assert found.verdict == "partly_explained" and found.ambiguity == [["dry_friction"]]


def test_half_a_probability_is_part_of_an_explanation():
    found = decided(nothing=0.01, something_else=0.39, friction=0.6)
    assert found.verdict == "partly_explained" and found.chosen is not None


def test_linear_effect_is_beside_every_explanation():
    linear = [(("added_mass",), 0.96), (("root_stiffness",), 0.04)]
    alone = decided(linear, nothing=0.97, something_else=0.02, friction=0.01)
    assert alone.nothing == 0.0  # it is that no more is missing
    assert (alone.verdict, alone.ambiguity) == ("named", [["added_mass"]])
    both = decided(linear, nothing=0.01, something_else=0.02, friction=0.97)
    assert both.ambiguity == [["added_mass", "dry_friction"]]


def test_smallest_set_reaches_the_probability_that_is_stated():
    reached, sets = smallest([("a", 0.5), ("b", 0.3), ("c", 0.15), ("d", 0.05)])
    assert reached == pytest.approx(0.95) and [name for name, _ in sets] == ["a", "b", "c"]


@pytest.mark.parametrize(("share", "partial"), [(0.3, True), (0.6, False), (None, False)])
def test_a_name_closes_half_of_what_other_records_miss(share, partial):
    rows = {"fit": {"closed_fraction": 0.9}, "holdout": {"closed_fraction": share}}
    assert Closing((), None, None, rows, "holdout").partial is partial


def test_a_name_that_leaves_most_is_a_part():
    found = partly_decision(decided(nothing=0.01, something_else=0.02, friction=0.95, damping=0.02))
    assert found.verdict == "partly_explained" and found.chosen is not None
    assert (
        partly_decision(decided(nothing=0.94, something_else=0.01, friction=0.05)).verdict == "none"
    )


def test_rounding_makes_no_probability_above_one():
    found = decided(
        nothing=1.0e-300, something_else=1.0e-300, friction=0.9, friction_beside=0.1 + 1.0e-12
    )
    assert found.rows[0][1] == found.probabilities[0] == 1.0


def test_gap_of_all_supports_is_no_other_than_a_common_gain():
    name = "gap@all"
    found = decided(
        fits={name: fit_at()}, nothing=0.01, something_else=0.01, **{name: 0.98, "friction": 0.0001}
    )
    assert found.verdict == "ambiguous"
    assert found.ambiguity == [["gap"], ["sensor_gain"]]
    assert found.probabilities == pytest.approx([0.49, 0.49])
    assert exactly_alike(candidate_named("gap@plate_1")) == [["gap"]]
    both = sorted(map(sorted, exactly_alike(candidate_named("added_mass@apex+gap@all"))))
    assert both == [["added_mass", "gap"], ["added_mass", "sensor_gain"]]
