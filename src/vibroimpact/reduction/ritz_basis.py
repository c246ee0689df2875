"""The Ritz basis: families of vectors, made mass- and stiffness-orthonormal, for each uncoupled
group of degrees of freedom.

Families (paper, section 2.3): free_modes of the tube without contact, constrained_modes with every
contact point held in both transverse directions, attachment_shapes = static responses to a unit
force at each contact point and direction.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg, sparse
from scipy.sparse import csgraph

FAMILIES = ("free_modes", "constrained_modes", "attachment_shapes")
# A direction in which unit vectors (strain-energy norm) reach less than this beyond the free modes
# is dropped: it holds less than 1e-10 of anyone's energy, so no frequency moves by more, and the
# static shapes' own singular values stay above 7e-3.
RANK_TOLERANCE = 1.0e-5
# lowest eigenvalue of the stiffness scaled to a unit diagonal: below it a rigid-body motion is free
SINGULAR_BELOW = 1.0e-14
RIGID_BODY_SHIFT = 1.0e-9  # of the highest eigenvalue: makes the stiffness of a free tube definite
RIGID_BODY_TOLERANCE = 1.0e-6  # of the shift, below it a squared frequency is 0


@dataclass(frozen=True, eq=False)
class DofGroup:
    """A group of degrees of freedom that mass, stiffness and contact couple to no other one.

    dofs (dof,) indices into the structure's; mass, stiffness (dof, dof) dense; contact
    (contact_row, dof): the contact displacements that move in this group; contact_rows
    (contact_row,) their indices, 2 contact_point + direction.
    """

    dofs: np.ndarray
    mass: np.ndarray
    stiffness: np.ndarray
    contact: np.ndarray
    contact_rows: np.ndarray

    @cached_property
    def shift(self):
        """Return the mass shift in rad²/s² that makes stiffness + shift mass definite: 0 unless
        rigid-body motion is free.

        A shift that is small against the squared cut-off of the free modes does not change what the
        basis spans: it alters the part of a static shape that the free modes hold anyway.
        """
        return rigid_body_shift(self.stiffness, self.mass)

    @cached_property
    def factor(self):
        """Return (dof, dof) the lower Cholesky factor of stiffness + shift mass."""
        return linalg.cholesky(self.stiffness + self.shift * self.mass, lower=True)


def uncoupled_groups(mass, stiffness, contact_rows):
    """Return a list of DofGroup: the connected components of the sparsity of mass, stiffness (dof,
    dof) and contact (row, dof).

    Only exact zeros uncouple: for a tube that lies in a plane these are its in-plane and
    out-of-plane motions.
    """
    rows = contact_rows.reshape(-1, mass.shape[0])
    touched = sparse.csr_array((rows != 0.0).astype(float))
    pattern = (mass != 0).astype(float) + (stiffness != 0).astype(float) + touched.T @ touched
    _, component = csgraph.connected_components(pattern, directed=False)
    groups = []
    for number in range(component.max() + 1):
        dofs = np.flatnonzero(component == number)
        moving = np.flatnonzero((rows[:, dofs] != 0.0).any(axis=1))
        groups.append(
            DofGroup(
                dofs,
                mass[dofs][:, dofs].toarray(),
                stiffness[dofs][:, dofs].toarray(),
                rows[moving][:, dofs],
                moving,
            )
        )
    return groups


def rigid_body_shift(stiffness, mass):
    """Return the mass shift in rad²/s² that makes stiffness + shift mass definite: 0 where the
    stiffness is.
    """
    scale = 1.0 / np.sqrt(np.diag(stiffness))
    lowest = linalg.eigh(
        stiffness * scale * scale[:, None], eigvals_only=True, subset_by_index=[0, 0]
    )[0]
    return (
        RIGID_BODY_SHIFT * _highest_eigenvalue(stiffness, mass) if lowest < SINGULAR_BELOW else 0.0
    )


def eigenmodes(stiffness, mass, frequency_to_Hz):
    """Return (omega (mode,) rad/s, shapes (dof, mode) mass-orthonormal) up to a frequency;
    rigid-body modes get omega = 0 exactly.

    Solved for the flexibility 1/(omega² + shift): round-off is then relative to each mode, not to
    the highest one, which on short elements is 1e12 times the first.
    """
    shift = rigid_body_shift(stiffness, mass)
    least = 1.0 / ((2.0 * np.pi * frequency_to_Hz) ** 2 + shift)
    flexibility, shapes = linalg.eigh(
        mass, stiffness + shift * mass, subset_by_value=[least, np.inf]
    )
    return (
        _frequencies(1.0 / flexibility[::-1] - shift, shift),
        (shapes / np.sqrt(flexibility))[:, ::-1],
    )


def basis_vectors(group, basis, families=FAMILIES):
    """Return {family: (dof, vector)} for the `families` asked for.

    basis: free_modes_to_Hz, constrained_modes_to_Hz, attachment_shapes (bool). Free modes are
    mass-orthonormal, the others are not orthogonal to them.
    """
    vectors = {}
    if "free_modes" in families:
        vectors["free_modes"] = eigenmodes(group.stiffness, group.mass, basis.free_modes_to_Hz)[1]
    if "constrained_modes" in families and len(group.contact):
        # Holding the contact points is a projection on the null space of their rows, orthonormal so
        # that nothing is badly scaled.
        allowed = linalg.null_space(group.contact)
        _, shapes = eigenmodes(
            allowed.T @ group.stiffness @ allowed,
            allowed.T @ group.mass @ allowed,
            basis.constrained_modes_to_Hz,
        )
        vectors["constrained_modes"] = allowed @ shapes
    if "attachment_shapes" in families and basis.attachment_shapes and len(group.contact):
        vectors["attachment_shapes"] = linalg.cho_solve((group.factor, True), group.contact.T)
    return {family: shapes for family, shapes in vectors.items() if shapes.shape[1]}


def orthonormal_basis(group, vectors):
    """Return (omega (mode,) rad/s, shapes (dof, mode)): mass-orthonormal, stiffness-orthogonal
    shapes that span all `vectors`.

    vectors: {family: (dof, vector)}. Free modes stay as they are; what the other families add is
    taken orthogonal to them, its dependent directions are dropped (singular values, in the
    strain-energy norm, below RANK_TOLERANCE), and the remainder is made orthogonal in mass and
    stiffness. Working with L^T x, K + shift M = L L^T, keeps singular values to round-off where the
    Gram matrix x^T K x would lose half the digits: the static shapes of neighbouring contact points
    are nearly alike.
    """
    free = vectors.get("free_modes", np.zeros((len(group.dofs), 0)))
    omega = _frequencies(np.sum((group.factor.T @ free) ** 2, axis=0) - group.shift, group.shift)
    others = [shapes for family, shapes in vectors.items() if family != "free_modes"]
    if not others:
        return omega, free
    added_omega, added = _added_shapes(group, free, np.hstack(others))
    order = np.argsort(np.concatenate([omega, added_omega]), kind="stable")
    return np.concatenate([omega, added_omega])[order], np.hstack([free, added])[:, order]


def _added_shapes(group, free, others):
    """Return (omega (mode,) rad/s, shapes (dof, mode)): what `others` (dof, vector) add to the free
    modes (dof, mode).
    """
    energy = group.factor.T @ others
    energy /= np.linalg.norm(energy, axis=0)
    known, _ = np.linalg.qr(group.factor.T @ free)
    for _ in range(2):  # twice is enough: one pass leaves round-off times the part taken out
        energy -= known @ (known.T @ energy)
    directions, sizes, _ = np.linalg.svd(energy, full_matrices=False)
    kept = linalg.solve_triangular(
        group.factor.T, directions[:, sizes > RANK_TOLERANCE], lower=False
    )
    # kept is stiffness-orthonormal: the eigenvalues of its mass are 1/omega², so the lowest
    # frequencies lose no accuracy.
    flexibility, turn = np.linalg.eigh(kept.T @ group.mass @ kept)
    return (
        np.sqrt(1.0 / flexibility[::-1] - group.shift),
        kept @ (turn / np.sqrt(flexibility))[:, ::-1],
    )


def _highest_eigenvalue(stiffness, mass):
    """Return an estimate in rad²/s², right within a small factor, of the highest eigenvalue: the
    largest ratio of diagonal terms.
    """
    return float(np.max(np.diag(stiffness) / np.diag(mass)))


def _frequencies(squares, shift):
    """Return (mode,) rad/s from eigenvalues in rad²/s²: those below 1e-6 of the `shift` are
    rigid-body motion, exactly 0.
    """
    return np.sqrt(np.where(squares < RIGID_BODY_TOLERANCE * shift, 0.0, squares))
