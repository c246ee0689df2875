"""Pieces of the identification of several supports: words on what is known, the step to a pole."""

import numpy as np
import pytest

from vibroimpact.identify.graded_supports import graded_supports, what_is_known
from vibroimpact.identify.linear.poles import first_pole, frequency_of
from vibroimpact.identify.linear.support_groups import grouped_supports, reached_supports
from vibroimpact.identify.linear.supported_structure import SupportedStructure
from vibroimpact.identify.pole_step import step_to_pole
from vibroimpact.identify.support_fit import FoundSupports, SupportSearch, inverse_information

NAMES = ("left.y", "right.y")


def tube(model, groups):
    """The structure with the supports of some groups."""
    directions, modes = reached_supports(model, groups)
    return SupportedStructure(model, directions, modes, np.array([20.0]))


def test_a_product_that_is_known_is_named():
    # ln k_left + ln k_right is known within 5 %, their difference is not.
    sum_of, difference = np.array([1.0, 1.0]) / np.sqrt(2.0), np.array([1.0, -1.0]) / np.sqrt(2.0)
    covariance = 0.05**2 * np.outer(sum_of, sum_of) + 4.0 * np.outer(difference, difference)
    assert what_is_known(NAMES, covariance, 0) == (
        "only the product k(left.y)^0.71 k(right.y)^0.71 is known, within 5%"
    )
    alone = what_is_known(NAMES, np.diag([0.01**2, 1.0]), 1)
    assert alone == "a change of k by a factor of 2.72 is within the scatter of the data"


def test_what_the_residual_does_not_see_is_unknown():
    jacobian = np.array([[2.0, 0.0], [1.0, 0.0], [0.0, 0.0]])
    inverse = inverse_information(jacobian)
    assert inverse[0, 0] == pytest.approx(0.2) and inverse[1, 1] > 1.0e6


def test_with_one_support_the_pole_fixes_it_from_anywhere(study_model):
    k, c = 1.0e5, 62.0525
    pole = first_pole(study_model, k, c)
    start = FoundSupports(np.array([2.0e4]), np.array([5.0]), np.diag([1.0, 100.0**2]))
    wanted = (*frequency_of(pole), np.zeros((2, 2)))
    found = step_to_pole(tube(study_model, "all"), start, wanted)
    assert (found.k[0], found.c[0]) == pytest.approx((k, c), rel=1e-6)
    assert np.abs(found.covariance).max() < 1e-9


def test_a_pole_moves_what_is_least_known(study_model):
    structure = tube(study_model, "each")
    k, c = np.array([1.0e5, 1.0e5]), np.array([60.0, 60.0])
    pole = first_pole(study_model, 1.2e5, 60.0)
    covariance = np.diag([0.01**2, 1.0, 1.0, 100.0**2])
    start = FoundSupports(k, c, covariance)
    found = step_to_pole(structure, start, (*frequency_of(pole), np.zeros((2, 2))))
    assert found.k[0] == pytest.approx(1.0e5, rel=1e-3) and found.k[1] > 1.3e5
    reached, _ = structure.pole(found.k, found.c, pole)
    assert reached == pytest.approx(pole, rel=1e-6)


@pytest.mark.parametrize(
    "k, error, resolved", [(1.0e5, 0.1, True), (1.0e3, 0.3, False), (1.0e7, 0.3, True)]
)
def test_a_soft_support_must_differ_from_zero_a_stiff_one_not(study_model, k, error, resolved):
    structure = tube(study_model, "all")
    covariance = np.diag([error**2, 1.0])
    found = FoundSupports(np.array([k]), np.array([50.0]), covariance)
    search = SupportSearch((1.0, 1.0e9), 130.0)
    (estimate,) = graded_supports("broadband", found, structure, search)
    assert np.isfinite(estimate.k) == resolved
    assert resolved or "does not differ from 0" in estimate.note


def test_own_compliance_is_that_of_a_unit_force(study_model):
    # A large stiffness moves the support by what its force would move it without.
    structure = tube(study_model, "each")
    none = np.zeros(2)
    free = structure.own_compliance(none)
    held = structure.own_compliance(np.array([0.0, 1.0e9]))
    assert held[0] < free[0] and held[1] == pytest.approx(free[1])
    assert free[0] == pytest.approx(free[1], rel=1e-6)  # the legs are alike


def test_supports_left_out_of_the_groups_are_groups_of_their_own():
    supports = ("a", "b", "c")
    assert grouped_supports(supports, "all") == {"all": supports}
    assert grouped_supports(supports, "each") == {name: (name,) for name in supports}
    assert grouped_supports(supports, (("a", "c"),)) == {"a+c": ("a", "c"), "b": ("b",)}
