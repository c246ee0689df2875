"""No more than two effects are named, those of the lowest record included."""

from types import SimpleNamespace

import pytest

from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.linear_analysis import taken_for_linear
from vibroimpact.linear_stage.prepared import Prepared

PAIR = "added_mass@apex+modal_damping@structure"


@pytest.mark.parametrize(
    ("adopted", "candidate", "expected"),
    [
        (None, "gap@all", True),
        (None, "gap@all+hertz@all", True),
        ("added_mass@apex", "gap@all", True),
        ("added_mass@apex", "gap@all+hertz@all", False),
        (PAIR, "gap@all", False),
        (PAIR, "gap@all+hertz@all", False),
        (PAIR, "coulomb_friction@apex@alone", True),
        (PAIR, "coulomb_friction@apex@alone+hertz@all", True),
    ],
)
def test_at_most_two_effects_with_the_adopted_ones(adopted, candidate, expected):
    prepared = Prepared([], adopted=None if adopted is None else {"name": adopted})
    assert prepared.room(candidate_named(candidate)) is expected


@pytest.mark.parametrize(
    ("adopted", "in_place", "expected"),
    [
        (None, [], ["coulomb_friction@apex"]),
        ("added_mass@apex", [], ["coulomb_friction@apex"]),
        (
            "added_mass@apex",
            ["coulomb_friction@apex"],
            ["coulomb_friction@apex", "coulomb_friction@apex@alone"],
        ),
        (PAIR, ["coulomb_friction@apex"], ["coulomb_friction@apex@alone"]),
        (PAIR, [], []),
    ],
)
def test_simulated_variants_of_a_candidate(adopted, in_place, expected):
    """What there is no room for is not simulated, and what can not have been taken for a linear
    effect not in its place.
    """
    prepared = Prepared(
        [], adopted=None if adopted is None else {"name": adopted}, in_place=in_place
    )
    assert [
        placed.name
        for placed in prepared.beside_or_in_place(candidate_named("coulomb_friction@apex"))
    ] == expected


def test_no_place_is_excluded_without_linear_modes():
    candidates = [
        candidate_named(name) for name in ("coulomb_friction@apex", "gap@all", "clearance@left_leg")
    ]
    touching = SimpleNamespace(linear_stage=False, measured_fit=None)
    prepared = Prepared([], adopted={"name": "added_mass@apex", "gain": 100.0})
    assert taken_for_linear(touching, None, prepared, candidates) == [
        "coulomb_friction@apex",
        "clearance@left_leg",
    ]
