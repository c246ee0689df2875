"""Pairs by another law of one of their quantities: which they are, and where they are searched
from.
"""

from types import SimpleNamespace

import numpy as np

from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.same_quantity import exchanged, starts

PAIR = candidate_named("hertz@all+foliate_obstacle@all")
VALUES = {"excitation": {"point": "shaker", "direction": [0.0, -2.0, 0.0]}}


def test_law_is_replaced_by_one_of_the_same_quantity():
    assert [(pair.name, number) for pair, number in exchanged(PAIR, VALUES)] == [
        ("contact_stiffness@all+foliate_obstacle@all", 0)
    ]
    assert exchanged(candidate_named("gap@all+foliate_obstacle@all"), VALUES) == []
    assert exchanged(candidate_named("hertz@all+contact_stiffness@all"), VALUES) == []


def test_saturating_spring_is_replaced_by_a_linear_one():
    """A rod along the force; a rod is at the drive point alone, and along an axis."""
    spring = candidate_named("coulomb_friction@apex+saturation_stiffness@shaker")
    assert [(pair.name, number) for pair, number in exchanged(spring, VALUES)] == [
        ("coulomb_friction@apex+lateral_stinger@along_y", 1)
    ]
    assert (
        exchanged(candidate_named("coulomb_friction@apex+saturation_stiffness@apex"), VALUES) == []
    )
    assert (
        exchanged(spring, {"excitation": {"point": "shaker", "direction": [0.0, 1.0, 1.0]}}) == []
    )


def test_replacement_search_starts_from_the_partner():
    ((pair, number),) = exchanged(PAIR, VALUES)
    points = starts(pair, number, SimpleNamespace(candidate=PAIR, unit=np.array([0.3, 0.7, 0.5])))
    np.testing.assert_allclose(points[:, 1:], np.tile([0.7, 0.5], (len(points), 1)))
    np.testing.assert_allclose(points[:, :1], pair.first.design())
