"""The values that the screening tries."""

from dataclasses import replace

import numpy as np
import pytest

from tests.support.straight_path import straight_path
from vibroimpact.diagnosis.bench import holding_lines
from vibroimpact.diagnosis.catalogue import far_terms, halfway, locations, within_priors
from vibroimpact.diagnosis.explanations import Point, Term
from vibroimpact.diagnosis.screening import Screened, trials_again
from vibroimpact.diagnosis.search import one_law
from vibroimpact.effects.places import between
from vibroimpact.effects.registry import EFFECTS

TUBE = {"kind": "tube", "outer_diameter_m": 0.02, "wall_thickness_m": 0.001}


def test_every_effect_has_trials_that_can_be_run(comparison):
    """At its first place: values that no structure can have would leave it out of the search."""
    structure, bench = comparison.structure, comparison.screened()
    failed = []
    for effect in EFFECTS.values():
        place = locations(effect, structure.values, structure.names, True, 8)[:1]
        terms = [term for each in place for term in far_terms(effect, each, comparison.sizes)]
        lines = holding_lines(bench, [Point((term,)) for term in terms]) if terms else np.zeros(1)
        if not np.isfinite(lines).reshape(len(lines), -1).all(axis=1).any():
            failed.append(effect.id)
    assert failed == []


@pytest.mark.parametrize(
    ("effect", "size", "share"),
    [("hunt_crossley", "slowness", 0.5), ("contact_damping", "contact_stiffness", 1.5e-5)],
)
def test_dissipation_by_which_right_codes_differ_is_no_effect(comparison, effect, size, share):
    """In contact, by the step alone: half of the steps take as much as an alpha of 0.08 s/m."""
    sizes = comparison.sizes
    for times, within in ((0.9, True), (1.1, False)):
        term = Term(effect, "all", (times * share * sizes[size],))
        assert within_priors(term, comparison.signals.rate, sizes) == within


def test_damping_that_nuisances_undo_is_no_effect(comparison):
    """It would be that of modes above the band alone."""
    rate, sizes = comparison.signals.rate, comparison.sizes
    term = Term("modal_damping", "all", (1.97,))
    for damping, within in (((), False), ((0.1, -0.1), False), ((-0.6, -0.4), True)):
        [net] = Point((term,), damping=damping).net_terms
        assert within_priors(net, rate, sizes) == within


def test_few_trials_of_an_effect_are_all_tried_again():
    """What gained most before another effect was known may be the wrong value."""
    few = [Term("gap", "all", (value,)) for value in (0.4, 0.65, 1.5, 2.5)]
    many = [Term("clearance", "arc_300_0mm", (1e-5 * gap, 1e5)) for gap in range(1, 40)]
    before = [Screened(Point((term,)), 1.0) for term in (*many, *few[::-1])]
    assert set(trials_again([*few, *many], before)) == {*few, *many[:2]}


@pytest.mark.parametrize("effect", ["hertz", "foliate_trefoil", "gap"])
def test_an_effect_of_supports_is_tried_at_each(comparison, effect):
    structure = comparison.structure
    found = locations(EFFECTS[effect], structure.values, structure.names, True, 8)
    assert found == ["all", "left", "right"]


def test_values_that_make_no_model_have_no_lines(comparison):
    plate = Term("plate_flexibility", "left", (1.0e5, 0.4, 0.9))  # no fraction of critical damping
    lines = holding_lines(comparison.screened(), [Point((plate,)), Point((plate,))])
    assert lines.shape[:2] == (2, 2) and np.isnan(lines).all()


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        (
            Term("added_mass", "arc_300_0mm", (0.1,)),
            [("arc_287_5mm", (0.1,)), ("arc_312_5mm", (0.1,))],
        ),
        (
            Term("preload", "all", (1.0, 0.0)),
            [("all", (0.924, -0.383)), ("all", (0.924, 0.383))],
        ),
        (
            Term("foliate_lands", "all", (0.0,)),
            [("all", (1.374,)), ("all", (0.196,))],
        ),
        (Term("gap", "left", (2.0,)), []),
    ],
)
def test_terms_half_way_to_the_next(term, expected):
    tube = {"structure": straight_path(0.5, [0.0, 0.0, 1.0], TUBE, (2.0e11, 0.3, 8000.0))}
    found = [(each.location, each.values) for each in halfway(term, tube, 20)]
    assert [place for place, _ in found] == [place for place, _ in expected]
    for (_, own), (_, wanted) in zip(found, expected, strict=True):
        assert own == pytest.approx(wanted, abs=1e-3)


def test_a_mode_above_the_lines_is_not_named(comparison):
    model = comparison.structure.with_terms(())
    inside = [int(name.removeprefix("mode_")) - 1 for name in comparison.resonant]
    assert inside and model.frequencies[inside].max() < comparison.band[1]
    low = replace(comparison, signals=comparison.signals)
    object.__setattr__(low, "band", (comparison.band[0], 1.2 * model.frequencies[0]))
    assert low.resonant == {"mode_1"}


@pytest.mark.parametrize(
    ("place", "other", "beside", "one"),
    [
        (0.573, "clearance", 0.572, True),
        (0.573, "clearance", 0.700, False),
        (0.573, "added_mass", 0.573, False),  # no law of a displacement
        (None, "clearance", None, False),  # a named point may bear two
    ],
)
def test_two_laws_at_one_place_of_a_tube_are_one(place, other, beside, one):
    where = ["tip" if own is None else between(own) for own in (place, beside)]
    terms = Term("saturation_stiffness", where[0], (1.0e3, 1.0)), Term(other, where[1], (1.0, 1.0))
    assert one_law(terms, 2.0) == one
