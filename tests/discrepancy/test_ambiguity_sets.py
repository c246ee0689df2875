"""Whom the contact levels can not tell from the best: aliases alone and beside another effect, and
a gap from its scale.
"""

from vibroimpact.discrepancy.candidates import Pair, candidate_named
from vibroimpact.discrepancy.naming import not_told_apart
from vibroimpact.discrepancy.verdict import local_sets

GAP_AND_DAMPING = {
    "gap@all+hunt_crossley@all": 1755.0,
    "gap@all+contact_damping@all": 1725.0,
    "gap@all+dry_friction@all": 1725.0,
}


def gains(rows):
    """{name: (gain in all, on fit records, on held-out records)}."""
    return {name: (gain, gain, 0.0) for name, gain in rows.items()}


def test_pairs_differing_by_an_alias_are_ambiguous():
    assert not_told_apart(gains(GAP_AND_DAMPING), "gap@all+hunt_crossley@all") == [
        "gap@all+contact_damping@all"
    ]


def test_the_order_of_a_pair_does_not_matter():
    rows = {"gap@all+hunt_crossley@all": 1755.0, "contact_damping@all+gap@all": 1725.0}
    assert not_told_apart(gains(rows), "gap@all+hunt_crossley@all") == [
        "contact_damping@all+gap@all"
    ]


def test_distant_alias_joins_only_if_it_explains_all():
    rows = gains(GAP_AND_DAMPING | {"gap@all+contact_damping@all": 1600.0})
    assert not_told_apart(rows, "gap@all+hunt_crossley@all") == []
    assert not_told_apart(rows, "gap@all+hunt_crossley@all", {"gap@all+contact_damping@all"}) == [
        "gap@all+contact_damping@all"
    ]


def test_saturating_spring_is_alias_of_a_linear_one():
    rows = gains(
        {
            "saturation_stiffness@shaker+quadratic_drag@tube": 3500.0,
            "lateral_stinger@along_y+quadratic_drag@tube": 3425.0,
        }
    )
    assert not_told_apart(rows, "saturation_stiffness@shaker+quadratic_drag@tube", set(rows)) == [
        "lateral_stinger@along_y+quadratic_drag@tube"
    ]


def test_pairs_differing_in_both_effects_are_no_aliases():
    rows = {"gap@all+hunt_crossley@all": 1755.0, "contact_damping@all+dry_friction@all": 1725.0}
    assert not_told_apart(gains(rows), "gap@all+hunt_crossley@all") == []


def test_effect_with_common_gain_is_alias_of_a_gap():
    assert local_sets(candidate_named("gap@all"), gains({"gap@all": 100.0}), {"gap@all"}) == [
        (["gap"], False),
        (["sensor_gain"], False),
    ]
    assert local_sets(candidate_named("gap@left"), gains({"gap@left": 100.0}), {"gap@left"}) == [
        (["gap"], False)
    ]


def test_common_gain_alias_holds_in_pairs():
    best = candidate_named("gap@all+hunt_crossley@all")
    assert isinstance(best, Pair)
    sets = [ids for ids, _ in local_sets(best, gains(GAP_AND_DAMPING), set(GAP_AND_DAMPING))]
    assert sets == [
        ["gap", "hunt_crossley"],
        ["contact_damping", "gap"],
        ["hunt_crossley", "sensor_gain"],
        ["contact_damping", "sensor_gain"],
    ]


def test_laws_of_one_quantity_compare_by_added_gain():
    """Two codes differ by a quarter of what a contact's law changes, whatever a gap changes beside
    it.
    """
    rows = gains(GAP_AND_DAMPING | {"gap@all+contact_damping@all": 1600.0})
    best = "gap@all+hunt_crossley@all"
    assert not_told_apart(rows, best, added={"hunt_crossley": 650.0, "gap": 1200.0}) == [
        "gap@all+contact_damping@all"
    ]
    assert not_told_apart(rows, best, added={"hunt_crossley": 400.0, "gap": 1200.0}) == []
