"""The Ritz basis: families of vectors, made orthonormal for each uncoupled group of dofs.

Families (Thénint, Balmes and Corus 2012, section 2.3):

- free_modes: modes of the tube without contact;
- constrained_modes: modes with every contact point fixed in both transverse directions;
- attachment_shapes: static responses to a unit force at each contact point and direction.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy import linalg, sparse
from scipy.sparse import csgraph

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.io.memo import Memo, content_key

GROUPS = Memo()
FAMILIES = ("free_modes", "constrained_modes", "attachment_shapes")
# A direction is dropped when unit vectors (strain-energy norm) extend beyond the free modes by
# less than this. It holds less than 1e-10 of the energy of any vector, so no frequency moves by
# more. The singular values of the static shapes are above 7e-3.
RANK_TOLERANCE = 1.0e-5
# The stiffness is factored as it is when its lowest eigenvalue, scaled to a unit diagonal, is not
# below this. If rigid-body motion is free, or an element is 1e-4 of the tube, it is below.
SINGULAR_BELOW = 1.0e-14
DEFINITE_AT = 1.0e-10  # lowest scaled eigenvalue with the shift
# Round-off of a strain energy, over the sum of the absolute values of its terms. Rigid motions of
# free tubes have 6e-17 at most. A bending mode at this bound is right to 5e-3.
ROUND_OFF = 1.0e-15


@dataclass(frozen=True, eq=False)
class DofGroup:
    """Degrees of freedom that mass, stiffness and contact couple to no others.

    dofs: (dof,) indices into those of the structure.
    mass, stiffness: (dof, dof) dense.
    contact: (contact_row, dof), the contact displacements that move in this group.
    contact_rows: (contact_row,) their indices, 2 contact_point + direction.
    """

    dofs: np.ndarray
    mass: np.ndarray
    stiffness: np.ndarray
    contact: np.ndarray
    contact_rows: np.ndarray
    _free_modes: dict[float, tuple[np.ndarray, np.ndarray]] = field(
        default_factory=dict, init=False, repr=False
    )

    def free_modes(self, to_Hz: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the `eigenmodes` of the motion without contact; computed once."""
        if to_Hz not in self._free_modes:
            self._free_modes[to_Hz] = eigenmodes(self.stiffness, self.mass, to_Hz, self.shift)
        return self._free_modes[to_Hz]

    @cached_property
    def shift(self) -> float:
        """Return the mass shift in rad²/s² that makes stiffness + shift mass positive definite.

        It is 0 unless the stiffness is singular to working precision. A shift far below the squared
        cut-off of the free modes does not change the span of the basis: it alters only the part of
        a static shape that the free modes contain anyway.
        """
        return rigid_body_shift(self.stiffness, self.mass)

    @cached_property
    def factor(self) -> np.ndarray:
        """Return (dof, dof) the lower Cholesky factor of stiffness + shift mass."""
        return linalg.cholesky(self.stiffness + self.shift * self.mass, lower=True)


def group_numbers(
    mass: sparse.csr_array, stiffness: sparse.csr_array, rows: np.ndarray
) -> np.ndarray:
    """Return (dof,) the number of each degree of freedom's group, see uncoupled_groups."""
    matrices = (
        part for own in (mass, stiffness) for part in (own.data != 0.0, own.indices, own.indptr)
    )

    def connected() -> np.ndarray:
        moved = sparse.csr_array((rows != 0.0).astype(float))
        pattern = (mass != 0).astype(float) + (stiffness != 0).astype(float) + moved.T @ moved
        return csgraph.connected_components(pattern, directed=False)[1]

    return GROUPS.get(content_key(rows != 0.0, *matrices), connected)


def uncoupled_groups(
    mass: sparse.csr_array, stiffness: sparse.csr_array, contact_rows: np.ndarray
) -> list[DofGroup]:
    """Return the DofGroups: connected components of the sparsity of mass, stiffness and contact.

    Only exact zeros uncouple. For a tube in a plane the groups are its in-plane and out-of-plane
    motions.

    mass, stiffness: (dof, dof).
    contact_rows: (..., dof).
    """
    rows = contact_rows.reshape(-1, mass.shape[0])
    component = group_numbers(mass, stiffness, rows)
    groups = []
    for number in range(component.max() + 1):
        dofs = np.flatnonzero(component == number)
        moving = np.flatnonzero((rows[:, dofs] != 0.0).any(axis=1))
        group = DofGroup(
            dofs=dofs,
            mass=mass[dofs][:, dofs].toarray(),
            stiffness=stiffness[dofs][:, dofs].toarray(),
            contact=rows[moving][:, dofs],
            contact_rows=moving,
        )
        groups.append(group)
    return groups


def rigid_body_shift(stiffness: np.ndarray, mass: np.ndarray) -> float:
    """Return the mass shift in rad²/s² that makes stiffness + shift mass positive definite.

    It is 0 if the stiffness is positive definite to working precision. Otherwise it is the least
    one that raises the lowest eigenvalue, scaled to a unit diagonal, to DEFINITE_AT: a shift sized
    by the highest frequency would swallow bending modes if an element is short.
    """
    diagonal = np.diag(stiffness)
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))  # a dof may be free on its own
    scaled = stiffness * scale * scale[:, None]
    lowest = linalg.eigh(scaled, eigvals_only=True, subset_by_index=[0, 0])[0]
    if lowest >= SINGULAR_BELOW:
        return 0.0
    _, vectors = linalg.eigh(scaled, subset_by_value=[-np.inf, SINGULAR_BELOW])
    vectors *= scale[:, None]  # the sum of their squares times the diagonal of the stiffness is 1
    return float(DEFINITE_AT / linalg.eigvalsh(vectors.T @ mass @ vectors)[0])


def eigenmodes(
    stiffness: np.ndarray, mass: np.ndarray, frequency_to_Hz: float, shift: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return (omega (mode,) rad/s, mass-orthonormal shapes (dof, mode)) up to a frequency in Hz.

    Rigid-body modes have omega = 0 exactly. The problem is solved for the flexibility
    1/(omega² + shift), so that round-off is relative to each mode and not to the highest one, which
    on short elements is 1e12 times the first.

    shift: rigid_body_shift of the two, if it is known.
    """
    if shift is None:
        shift = rigid_body_shift(stiffness, mass)
    least = 1.0 / ((2.0 * np.pi * frequency_to_Hz) ** 2 + shift)
    flexibility, shapes = linalg.eigh(
        mass, stiffness + shift * mass, subset_by_value=[least, np.inf]
    )
    shapes = (shapes / np.sqrt(flexibility))[:, ::-1]
    return _frequencies(1.0 / flexibility[::-1] - shift, shift, stiffness, shapes), shapes


def basis_vectors(group: DofGroup, basis: ConfigPart) -> dict[str, np.ndarray]:
    """Return {family: (dof, vector)} of the families that a group has.

    Free modes are mass-orthonormal; the other families are not orthogonal to them.

    basis: free_modes_to_Hz, constrained_modes_to_Hz, attachment_shapes (bool).
    """
    vectors = {"free_modes": group.free_modes(basis.free_modes_to_Hz)[1]}
    if len(group.contact):
        # Fixed contact points restrict the motion to the null space of their rows. Its basis is
        # orthonormal, so that nothing is badly scaled.
        allowed = linalg.null_space(group.contact)
        _, shapes = eigenmodes(
            allowed.T @ group.stiffness @ allowed,
            allowed.T @ group.mass @ allowed,
            basis.constrained_modes_to_Hz,
        )
        vectors["constrained_modes"] = allowed @ shapes
    if basis.attachment_shapes and len(group.contact):
        vectors["attachment_shapes"] = linalg.cho_solve((group.factor, True), group.contact.T)
    return {family: shapes for family, shapes in vectors.items() if shapes.shape[1]}


def orthonormal_basis(
    group: DofGroup, vectors: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return (omega (mode,) rad/s, shapes (dof, mode)) that span all `vectors`.

    The shapes are mass-orthonormal and stiffness-orthogonal. Free modes stay as they are. The other
    families are made orthogonal to them; their dependent directions are dropped (singular values in
    the strain-energy norm below RANK_TOLERANCE); the rest is made orthogonal in mass and stiffness.

    Singular values are those of L^T x with K + shift M = L L^T. The Gram matrix x^T K x would lose
    half the digits, because the static shapes of neighbouring contact points are nearly equal.

    vectors: {family: (dof, vector)}.
    """
    free = vectors.get("free_modes", np.zeros((len(group.dofs), 0)))
    squares = np.sum((group.factor.T @ free) ** 2, axis=0) - group.shift
    omega = _frequencies(squares, group.shift, group.stiffness, free)
    others = [shapes for family, shapes in vectors.items() if family != "free_modes"]
    if not others:
        return omega, free
    added_omega, added = _added_shapes(group, omega, free, np.hstack(others))
    order = np.argsort(np.concatenate([omega, added_omega]), kind="stable")
    return np.concatenate([omega, added_omega])[order], np.hstack([free, added])[:, order]


def _added_shapes(
    group: DofGroup, omega: np.ndarray, free: np.ndarray, others: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return (omega (mode,) rad/s, shapes (dof, mode)) that `others` add to the free modes.

    omega, free: (mode,) rad/s and (dof, mode) of the free modes.
    others: (dof, vector).
    """
    energy = group.factor.T @ others
    energy /= np.linalg.norm(energy, axis=0)
    free_directions, _ = np.linalg.qr(group.factor.T @ free)
    for _ in range(2):  # one pass leaves round-off times the part removed; a second is enough
        energy -= free_directions @ (free_directions.T @ energy)
    directions, sizes, _ = np.linalg.svd(energy, full_matrices=False)
    independent = directions[:, sizes > RANK_TOLERANCE]
    added = linalg.solve_triangular(group.factor.T, independent, lower=False)
    # A rigid motion has hardly any strain energy: only its mass shows how much of it is left.
    rigid = free[:, omega == 0.0]
    if rigid.size:
        added -= rigid @ (rigid.T @ (group.mass @ added))
    # `added` is stiffness-orthonormal: the eigenvalues of its mass are 1/omega², so the lowest
    # frequencies lose no accuracy.
    flexibility, rotation = np.linalg.eigh(added.T @ group.mass @ added)
    # Rigid motion that no free mode holds is here, at zero up to round-off.
    omega = np.sqrt(np.maximum(1.0 / flexibility[::-1] - group.shift, 0.0))
    return omega, added @ (rotation / np.sqrt(flexibility))[:, ::-1]


def _frequencies(
    squares: np.ndarray, shift: float, stiffness: np.ndarray, shapes: np.ndarray
) -> np.ndarray:
    """Return (mode,) rad/s from eigenvalues in rad²/s².

    If there is a shift, those below the round-off of their strain energy are rigid-body motion,
    exactly 0. Source of the bound: N. J. Higham, Accuracy and Stability of Numerical Algorithms
    (SIAM 2002), eq. 3.12.

    shapes: (dof, mode), mass-orthonormal.
    """
    if shift == 0.0:
        return np.sqrt(np.maximum(squares, 0.0))
    terms = np.sum(np.abs(shapes) * (np.abs(stiffness) @ np.abs(shapes)), axis=0)
    return np.sqrt(np.where(squares < ROUND_OFF * terms, 0.0, squares))
