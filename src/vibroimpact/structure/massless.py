"""Condensation of the directions in which a structure has no mass.

A superelement or a lumped mass leaves degrees of freedom, or combinations of them, without mass.
With N the directions without mass and Q the rest, x = Q q + N b, they follow at rest if no force
acts on them:

    N^T K (Q q + N b) = 0,    T = Q - N (N^T K N)^+ N^T K Q,    x = T q + R r.

T^T K N = 0, so that T q has the modes of the structure exactly. A force on a named point may act on
N. The static shapes R of unit forces there are kept too, K-orthonormal, with the mass that puts
them at the highest frequency of T q: below, they are a flexibility. A direction with neither mass
nor stiffness is held at zero. R. J. Guyan, Reduction of stiffness and mass matrices, AIAA Journal 3
(1965) 380; residual flexibility: R. R. Craig and A. J. Kurdila, Fundamentals of Structural Dynamics
(Wiley 2006), section 17.3.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg, sparse
from scipy.sparse import csgraph

from .definiteness import EPSILON

MOST_DOFS = 4000  # of a structure that is condensed: it takes dense matrices
SHOWN = 6  # dofs that are named in a message
ROUND_OFF = 10.0  # times the number of dofs and epsilon: a smaller eigenvalue is not a mass
NO_SHAPE = 1.0e-6  # of the largest: a smaller static shape adds nothing


@dataclass(frozen=True, eq=False)
class Condensed:
    """The condensed structure.

    recovery (all dofs, dof): displacement of the original dofs per unit dof: T, then R.
    kept (all dofs, dof): orthonormal basis of the directions with mass: Q, then zeros.
    massless (all dofs, direction): orthonormal basis of those without: N.
    mass, stiffness (dof, dof).
    """

    recovery: np.ndarray
    kept: np.ndarray
    massless: np.ndarray
    mass: sparse.csr_array
    stiffness: sparse.csr_array

    def of(self, damping: sparse.csr_array) -> sparse.csr_array:
        """Return (dof, dof) a damping matrix (all dofs, all dofs) of the condensed structure."""
        reduced = self.recovery.T @ (damping @ self.recovery)
        return sparse.csr_array(0.5 * (reduced + reduced.T))

    def told(self) -> str:
        """Return a sentence on the condensed directions."""
        count = self.massless.shape[1]
        most = np.flatnonzero(np.sum(self.massless**2, axis=1) > 0.5)
        listed = ", ".join(map(str, most[:SHOWN])) + (", ..." if most.size > SHOWN else "")
        return (
            f"{count} direction{'s' if count > 1 else ''} without mass"
            f" ({f'dof {listed}' if listed else 'a combination of dofs'})"
            f" {'are' if count > 1 else 'is'} condensed to the stiffness of the others"
        )


def condense_massless(
    mass: sparse.csr_array, stiffness: sparse.csr_array, named: Sequence[int]
) -> Condensed | None:
    """Return the Condensed structure; None if every direction has mass, if there are too many
    degrees of freedom, or if the mass, or the stiffness of a direction without mass, is
    negative, which is refused later.

    mass, stiffness (dof, dof): symmetric.
    named: the dofs at which forces act or supports stand.
    """
    if mass.shape[0] > MOST_DOFS:
        return None
    kept, null = _directions(mass)
    if not null.shape[1] or not kept.shape[1]:
        return None
    soft = null.T @ (stiffness @ null)
    if np.diag(soft).min() < 0.0:
        return None
    size = np.sqrt(np.maximum(np.diag(soft), np.finfo(float).tiny))
    values, vectors = linalg.eigh(soft / size / size[:, None])
    round_off = len(soft) * EPSILON * np.abs(values).max()
    if values[0] < -round_off:
        return None
    stiff = values > round_off
    flexible = null @ (vectors[:, stiff] / np.sqrt(values[stiff]) / size[:, None])
    follow = kept - flexible @ (flexible.T @ (stiffness @ kept))
    own_mass, own_stiffness = kept.T @ (mass @ kept), follow.T @ (stiffness @ follow)
    shapes, sizes, _ = np.linalg.svd(flexible[list(named)].T, full_matrices=False)
    static = flexible @ shapes[:, sizes > NO_SHAPE * max(sizes.max(initial=0.0), EPSILON)]
    last = len(own_mass) - 1
    square = linalg.eigh(own_stiffness, own_mass, eigvals_only=True, subset_by_index=[last, last])
    beside = np.eye(static.shape[1])
    scale = float(stiffness.diagonal().max() / mass.diagonal().max())
    highest = float(square[0]) if square[0] > EPSILON * scale else scale
    recovery, kept = np.hstack([follow, static]), np.hstack([kept, np.zeros_like(static)])
    matrices = _symmetric(own_mass, beside / highest), _symmetric(own_stiffness, beside)
    return Condensed(recovery, kept, null, *matrices)


def _symmetric(first: np.ndarray, second: np.ndarray) -> sparse.csr_array:
    """Return the matrix of two blocks, with exactly equal halves."""
    return sparse.csr_array(linalg.block_diag(0.5 * (first + first.T), second))


def _directions(mass: sparse.csr_array) -> tuple[np.ndarray, np.ndarray]:
    """Return orthonormal bases ((dof, direction) with mass, (dof, direction) without), one after
    the other for the dofs that the mass couples.
    """
    labels = csgraph.connected_components(mass != 0, directed=False)[1]
    parts: tuple[list, list] = ([], [])
    for number in range(labels.max() + 1):
        own = np.flatnonzero(labels == number)
        for columns, part in zip(_split(mass[own][:, own].toarray()), parts, strict=True):
            whole = np.zeros((len(labels), columns.shape[1]))
            whole[own] = columns
            part.append(whole)
    return np.hstack(parts[0]), np.hstack(parts[1])


def _split(mass: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the directions of _directions, of dofs that the mass couples: unit vectors if all
    directions are of one kind.
    """
    whole, nothing = np.eye(len(mass)), np.zeros((len(mass), 0))
    diagonal = np.diag(mass)
    if not mass.any():
        return nothing, whole
    if np.any(diagonal <= 0.0):
        return whole, nothing
    scale = 1.0 / np.sqrt(diagonal)
    values, vectors = linalg.eigh(mass * scale * scale[:, None])
    least = ROUND_OFF * len(mass) * EPSILON * values[-1]
    if values[0] >= least or values[0] < -least:
        return whole, nothing
    without, _ = np.linalg.qr(scale[:, None] * vectors[:, values < least])
    return linalg.null_space(without.T), without
