"""Directions without mass are condensed: the modes stay, and so does the flexibility of a point."""

import numpy as np
import pytest
from scipy import linalg, sparse

from tests.support.matrix_structure import matrix_study
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.massless import condense_massless
from vibroimpact.structure.point_structure import build_point_structure
from vibroimpact.study.model_checks import check_model

SPRING = 1.0e6  # N/m
CHAIN = SPRING * (2.0 * np.eye(5) - np.eye(5, k=1) - np.eye(5, k=-1))  # ground to ground
MASS = np.diag([1.0, 2.0, 0.0, 1.5, 0.0])
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(5, 5)))[0]
# one massless dof, two; a combination of dofs
CASES = {"dofs": (MASS, CHAIN), "combinations": (TURN @ MASS @ TURN.T, TURN @ CHAIN @ TURN.T)}


def study(folder, mass, stiffness, named=(2,)):
    """The configuration of matrices with a named point at some dofs."""
    return matrix_study(folder, mass, stiffness, {f"p{dof}": dof for dof in named})


def finite_modes(mass, stiffness):
    """rad/s, of the flexibility: without mass, a direction has the eigenvalue 0 there."""
    flexible = linalg.eigh(mass, stiffness, eigvals_only=True)
    return np.sort(1.0 / np.sqrt(flexible[flexible > 1e-9 * flexible[-1]]))


@pytest.mark.parametrize("case", CASES)
def test_the_modes_are_those_of_the_whole_matrices(tmp_path, case):
    omega = build_model(study(tmp_path, *CASES[case])).omega
    expected = finite_modes(*CASES[case])
    assert len(expected) == 3
    assert omega[:3] == pytest.approx(expected, rel=1e-9)
    assert omega[3:] == pytest.approx(expected[-1], rel=1e-9)  # what is kept beside, per point


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("dof", range(5))
def test_a_named_point_keeps_its_static_flexibility(tmp_path, case, dof):
    built = build_point_structure(study(tmp_path, *CASES[case], named=(dof,)))
    row = built.point_rows(f"p{dof}")[0]
    ours = row @ np.linalg.solve(built.stiffness.toarray(), row)
    assert ours == pytest.approx(np.linalg.inv(CASES[case][1])[dof, dof], rel=1e-9)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("dof", range(5))
def test_a_point_that_is_held_gives_the_modes_of_the_rest(tmp_path, case, dof):
    """To the share of the flexibility that has mass beside: none in the lowest mode."""
    mass, stiffness = CASES[case]
    built = build_point_structure(study(tmp_path, mass, stiffness, named=(dof,)))
    free = linalg.null_space(built.point_rows(f"p{dof}")[:1])
    others = np.delete(np.arange(5), dof)
    ours = finite_modes(free.T @ built.mass @ free, free.T @ built.stiffness @ free)
    whole = finite_modes(mass[np.ix_(others, others)], stiffness[np.ix_(others, others)])
    assert ours[0] == pytest.approx(whole[0], rel=0.12)


def superelement(modes=8):
    """(mass, stiffness) of a rod without supports on its two ends and fixed-interface modes; the
    sum of an end and the last mode has no mass, as residual vectors of Nastran leave it.
    """
    count = 60
    stiffness = 1e8 * (2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1))
    stiffness[0, 0] = stiffness[-1, -1] = 1e8
    mass = np.diag(np.r_[0.5, np.ones(count - 2), 0.5])
    inner = slice(1, count - 1)
    _, shapes = linalg.eigh(stiffness[inner, inner], mass[inner, inner])
    basis = np.zeros((count, 2 + modes))
    basis[[0, -1], [0, 1]] = 1.0
    basis[inner, :2] = -np.linalg.solve(stiffness[inner, inner], stiffness[inner][:, [0, -1]])
    basis[inner, 2:] = shapes[:, :modes]
    massless = np.zeros(2 + modes)
    massless[[0, -1]] = np.sqrt(0.5)
    with_mass = np.eye(2 + modes) - np.outer(massless, massless)
    return with_mass @ basis.T @ mass @ basis @ with_mass, basis.T @ stiffness @ basis


def test_a_superelement_has_its_modes_free_and_held(tmp_path):
    mass, stiffness = superelement()
    built = build_point_structure(study(tmp_path, mass, stiffness, named=(0, 1)))
    assert built.condensed.massless.shape[1] == 1
    ours = built.mass.toarray(), built.stiffness.toarray()
    shift = 1e4  # rad²/s²: without supports, the stiffness alone is singular
    free = finite_modes(ours[0], ours[1] + shift * ours[0])
    assert free[:6] == pytest.approx(finite_modes(mass, stiffness + shift * mass)[:6], rel=1e-9)
    held = linalg.null_space(np.vstack([built.point_rows(f"p{end}")[0] for end in (0, 1)]))
    fixed = finite_modes(*(held.T @ each @ held for each in ours))
    assert fixed[:6] == pytest.approx(finite_modes(mass[2:, 2:], stiffness[2:, 2:])[:6], rel=1e-2)


def test_a_dof_without_mass_and_stiffness_is_held(tmp_path):
    mass, stiffness = np.pad(MASS, (0, 1)), np.pad(CHAIN, (0, 1))
    built = build_point_structure(study(tmp_path, mass, stiffness, named=(0, 5)))
    assert not built.point_rows("p5").any()
    assert build_model(study(tmp_path, mass, stiffness, named=(0,))).omega[:3] == pytest.approx(
        finite_modes(MASS, CHAIN), rel=1e-9
    )


def test_the_base_moves_all_of_the_mass(tmp_path):
    built = build_point_structure(study(tmp_path, MASS, CHAIN, named=range(5)))
    assert built.inertia[0] @ built.condensed.kept.T @ np.ones(5) == pytest.approx(MASS.sum())


def test_a_structure_with_mass_throughout_is_left_as_it_is():
    whole = sparse.csr_array(MASS + np.eye(5))
    assert condense_massless(whole, sparse.csr_array(CHAIN), [0]) is None


@pytest.mark.parametrize(
    "case, told",
    [
        ("dofs", "2 directions without mass (dof 2, 4) are condensed"),
        ("combinations", "2 directions without mass ("),
    ],
)
def test_the_check_tells_what_is_condensed(tmp_path, case, told):
    found = check_model(study(tmp_path, *CASES[case]))
    assert found.problems == () and f"structure.mass: {told}" in found.warnings[0]
