"""Mass and stiffness matrices that no structure at rest has are refused with file and number."""

import numpy as np
import pytest

from tests.support.matrix_structure import matrix_study
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.definiteness import IndefiniteMatrixError

CHAIN = 2.0 * np.eye(6) - np.eye(6, k=1) - np.eye(6, k=-1)
FREE = CHAIN - np.diag([1.0, 0.0, 0.0, 0.0, 0.0, 1.0])  # springs between the masses only
SPRING = 1.0e6  # N/m


@pytest.mark.parametrize("copies", [1, 70])
def test_a_negative_stiffness_is_refused_with_its_frequency(tmp_path, copies):
    """K = -K of a chain has the eigenvalues -4 k/m sin²(i pi / 14)."""
    stiffness = np.kron(np.eye(copies), -SPRING * CHAIN)
    config = matrix_study(tmp_path, np.eye(6 * copies), stiffness)
    with pytest.raises(IndefiniteMatrixError) as caught:
        build_model(config)
    lowest = 2.0 * np.sqrt(SPRING) * np.sin(6.0 * np.pi / 14.0) / (2.0 * np.pi)
    assert str(tmp_path / "k.npz") in str(caught.value)
    assert f"-({lowest:.4g} Hz)²" in str(caught.value) and "check the sign" in str(caught.value)


@pytest.mark.parametrize("part", [-1.0e-3, -1.0e-6, -1.0e-9])
def test_a_small_negative_eigenvalue_is_no_rigid_mode(tmp_path, part):
    """1e-9 of the highest is a mode of -(10 Hz)² below one of 318 Hz: far beyond round-off."""
    motions = np.linalg.qr(np.random.default_rng(3).normal(size=(6, 6)))[0]
    squares = 4.0 * SPRING * np.array([part, 0.01, 0.1, 0.3, 0.6, 1.0])
    config = matrix_study(tmp_path, np.eye(6), motions @ np.diag(squares) @ motions.T)
    with pytest.raises(IndefiniteMatrixError, match="negative eigenvalue"):
        build_model(config)


@pytest.mark.parametrize("copies", [1, 70])
def test_free_structures_keep_their_rigid_modes(tmp_path, copies):
    stiffness = np.kron(np.eye(copies), SPRING * FREE)
    model = build_model(matrix_study(tmp_path, np.eye(6 * copies), stiffness))
    assert np.sum(model.omega == 0.0) == copies
    elastic = 2.0 * np.sqrt(SPRING) * np.sin(np.pi * np.arange(1, 6) / 12.0)
    assert model.omega[copies::copies] == pytest.approx(elastic, rel=1e-5)


def test_masses_and_rotations_of_any_unit_are_taken(tmp_path):
    """Units of the dofs that differ by 1e6 change neither the check nor the frequencies."""
    units = np.diag([1.0, 1e-3, 1e3, 1.0, 1e-3, 1e3])
    model = build_model(matrix_study(tmp_path, units @ units, units @ (SPRING * FREE) @ units))
    elastic = 2.0 * np.sqrt(SPRING) * np.sin(np.pi * np.arange(1, 6) / 12.0)
    assert model.omega[1:] == pytest.approx(elastic, rel=1e-6)


@pytest.mark.parametrize(
    ("mass", "words"),
    [
        (np.diag([1.0, 1.0, 1.0, 1.0, -2.0, 1.0]), "dof 4 has the mass -2 kg on the diagonal"),
        (np.eye(6) + np.ones((6, 6)) - 1.999 * np.eye(6), "is not positive definite"),
    ],
)
def test_a_negative_mass_is_refused(tmp_path, mass, words):
    with pytest.raises(IndefiniteMatrixError) as caught:
        build_model(matrix_study(tmp_path, mass, SPRING * CHAIN))
    assert str(caught.value).startswith(str(tmp_path / "m.npz")) and words in str(caught.value)
    assert "condense" in str(caught.value)


def test_a_structure_without_any_mass_is_refused(tmp_path):
    with pytest.raises(IndefiniteMatrixError, match="dof 0 has the mass 0 kg"):
        build_model(matrix_study(tmp_path, np.zeros((6, 6)), SPRING * CHAIN))
