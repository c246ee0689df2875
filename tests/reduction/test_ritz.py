"""The Ritz basis: uncoupled groups, orthonormality, exact static compliance, dependent vectors,
free structures.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import linalg, sparse

from tests.structure.test_structure import plate, straight
from tests.structure.test_structure import tube as coarse_tube
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reduction.ritz_basis import basis_vectors, orthonormal_basis, uncoupled_groups

BASIS = SimpleNamespace(
    free_modes_to_Hz=2000.0, constrained_modes_to_Hz=800.0, attachment_shapes=True
)


def tube(root="clamped", bend=True):
    """A coarse U-tube, or its first leg alone, with five contact points."""
    end = SimpleNamespace(kind=root)
    legs = None if bend else straight(0.7)
    supports = [plate([-0.3, 0.0, 0.35], 5)]
    return coarse_tube(segments=legs, start=end, end=end, elements=(10, 20), supports=supports)


def groups_of(structure):
    return uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows())


@pytest.fixture(scope="module")
def groups():
    return groups_of(tube())


def test_a_plane_tube_has_an_in_plane_and_an_out_of_plane_group():
    structure = tube()
    groups = groups_of(structure)
    assert [sorted(set((group.dofs % 6).tolist())) for group in groups] == [[0, 2, 4], [1, 3, 5]]
    assert [group.contact_rows.tolist() for group in groups] == [[0, 2, 4, 6, 8], [1, 3, 5, 7, 9]]


def test_straight_tube_separates_axial_motion_and_torsion():
    groups = groups_of(tube(bend=False))
    assert [sorted(set((group.dofs % 6).tolist())) for group in groups] == [
        [0, 4],
        [1, 3],
        [2],
        [5],
    ]
    assert [len(group.contact) for group in groups] == [5, 5, 0, 0]


def test_a_contact_direction_across_two_planes_couples_them():
    unit = sparse.eye_array(3, format="csr")
    apart = uncoupled_groups(unit, unit, np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))
    coupled = uncoupled_groups(unit, unit, np.array([[1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]))
    assert [group.dofs.tolist() for group in apart] == [[0], [1], [2]]
    assert [group.dofs.tolist() for group in coupled] == [[0, 1], [2]]
    assert [group.contact_rows.tolist() for group in coupled] == [[0, 1], []]


def test_shapes_are_orthonormal_in_mass_and_stiffness(groups):
    for group in groups:
        omega, shapes = orthonormal_basis(group, basis_vectors(group, BASIS))
        assert np.allclose(shapes.T @ group.mass @ shapes, np.eye(len(omega)), rtol=0, atol=1e-9)
        scaled = shapes.T @ group.stiffness @ shapes / np.outer(omega, omega)
        assert np.allclose(scaled, np.eye(len(omega)), rtol=0, atol=1e-7)
        assert (np.diff(omega) >= 0.0).all()


def test_constrained_modes_hold_the_contact_points(groups):
    for group in groups:
        shapes = basis_vectors(group, BASIS)["constrained_modes"]
        assert shapes.shape[1] > 3
        assert np.abs(group.contact @ shapes).max() < 1e-10 * np.abs(shapes).max()


def test_contact_compliance_is_that_of_the_full_model(groups):
    for group in groups:
        full = group.contact @ linalg.solve(group.stiffness, group.contact.T, assume_a="pos")
        vectors = basis_vectors(group, BASIS)
        omega, shapes = orthonormal_basis(group, vectors)
        moved = group.contact @ shapes
        assert np.allclose((moved / omega**2) @ moved.T, full, rtol=1e-9, atol=0)
        del vectors["attachment_shapes"]
        omega, shapes = orthonormal_basis(group, vectors)
        moved = group.contact @ shapes
        assert not np.allclose(
            (moved / omega**2) @ moved.T, full, rtol=1e-5, atol=0
        )  # only attachment shapes make it exact


def test_dependent_vectors_add_nothing(groups):
    group = groups[0]
    vectors = basis_vectors(group, BASIS)
    omega, _ = orthonormal_basis(group, vectors)
    again = {
        **vectors,
        "constrained_modes": np.hstack([vectors["constrained_modes"]] * 2),
        "attachment_shapes": np.hstack(
            [
                vectors["attachment_shapes"],
                vectors["attachment_shapes"] @ np.ones((5, 2)),
                vectors["free_modes"],
            ]
        ),
    }
    repeated, _ = orthonormal_basis(group, again)
    assert repeated == pytest.approx(
        omega, rel=1e-4
    )  # residual vectors are no modes: round-off of the static shapes moves them


def test_free_tube_keeps_rigid_modes_and_static_flexibility():
    groups = groups_of(tube(root="free"))
    rigid = 0
    for group in groups:
        assert group.shift > 0.0
        omega, shapes = orthonormal_basis(group, basis_vectors(group, BASIS))
        rigid += np.sum(omega == 0.0)
        assert np.allclose(shapes.T @ group.mass @ shapes, np.eye(len(omega)), rtol=0, atol=1e-7)
        # held by springs at the contact points, the tube has the full model's frequencies: static
        # shapes are still the right ones
        stiff = 1.0e7
        moved = group.contact @ shapes
        reduced = linalg.eigvalsh(np.diag(omega**2) + stiff * moved.T @ moved)[:6]
        full = linalg.eigh(
            group.stiffness + stiff * group.contact.T @ group.contact,
            group.mass,
            eigvals_only=True,
            subset_by_index=[0, 5],
        )
        assert reduced == pytest.approx(
            full, rel=1e-6, abs=0.1
        )  # rad²/s²: what is left rigid is round-off
    assert rigid == 6


def test_frequencies_of_a_free_tube_do_not_contain_the_shift():
    narrow = SimpleNamespace(
        free_modes_to_Hz=20.0, constrained_modes_to_Hz=0.0, attachment_shapes=True
    )
    for group in groups_of(tube(root="free")):
        omega, shapes = orthonormal_basis(group, basis_vectors(group, narrow))
        squares = np.einsum("dm,dm->m", shapes, group.stiffness @ shapes)
        assert squares[omega > 0.0] == pytest.approx(omega[omega > 0.0] ** 2, rel=1e-6)
        assert omega[omega > 0.0][0] ** 2 < 1.0e5 * group.shift  # low enough to notice


def test_group_without_contact_has_free_modes_only(groups):
    no_shapes = SimpleNamespace(
        free_modes_to_Hz=2000.0, constrained_modes_to_Hz=800.0, attachment_shapes=False
    )
    assert list(basis_vectors(groups[0], no_shapes)) == ["free_modes", "constrained_modes"]
    torsion = groups_of(tube(bend=False))[3]
    wide = SimpleNamespace(
        free_modes_to_Hz=5000.0, constrained_modes_to_Hz=5000.0, attachment_shapes=True
    )
    assert list(basis_vectors(torsion, wide)) == ["free_modes"]


@pytest.mark.parametrize("theory", ["euler_bernoulli", "timoshenko"])
def test_short_elements_do_not_lose_the_first_modes(study_config, theory):
    """25 contact points in 30 mm: elements of 1.25 mm, highest frequency 1e6 times the first. The
    first modes stay those of other codes.
    """
    structure = study_config.structure.model_copy(update={"theory": theory})
    supports = tuple(support.model_copy(update={"points": 25}) for support in study_config.supports)
    model = build_model(
        study_config.model_copy(update={"structure": structure, "supports": supports})
    )
    expected = {"euler_bernoulli": [15.98, 29.02, 45.10], "timoshenko": [15.97, 28.96, 45.03]}[
        theory
    ]
    assert model.frequencies[:3] == pytest.approx(expected, rel=1.0e-3)
