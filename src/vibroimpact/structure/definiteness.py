"""Whether mass and stiffness matrices are those of a structure at rest: no direction without mass,
none that pushes away.
"""

from collections.abc import Iterable

import numpy as np
from scipy import linalg

EPSILON = float(np.finfo(float).eps)


class IndefiniteMatrixError(ValueError):
    """A mass or stiffness matrix that no structure at rest has; the message names its file."""


def require_definite(
    groups: Iterable[tuple[np.ndarray, np.ndarray, np.ndarray]], names: tuple[str, str]
) -> None:
    """Raise IndefiniteMatrixError unless mass is positive definite and stiffness not negative.

    groups: (dofs (dof,), mass (dof, dof), stiffness (dof, dof)) of uncoupled parts of a structure.
    names: of the mass and the stiffness in the message, such as their files.
    """
    for dofs, mass, stiffness in groups:
        _require_mass(dofs, mass, names[0])
        _require_stiffness(dofs, mass, stiffness, names[1])


def _require_mass(dofs: np.ndarray, mass: np.ndarray, name: str) -> None:
    diagonal = np.diag(mass)
    if np.any(diagonal <= 0.0):
        dof = int(np.argmin(diagonal))
        raise IndefiniteMatrixError(
            f"{name}: dof {dofs[dof]} has the mass {diagonal[dof]:.6g} kg on the diagonal, it must"
            " be > 0: condense the dofs without mass, or give them their inertia"
        )
    scale = 1.0 / np.sqrt(diagonal)
    scaled = mass * scale * scale[:, None]
    lowest, vectors = linalg.eigh(scaled, subset_by_index=[0, 0])
    if lowest[0] < len(dofs) * EPSILON:
        dof = int(dofs[np.argmax(np.abs(vectors[:, 0]))])
        raise IndefiniteMatrixError(
            f"{name}: is not positive definite (lowest eigenvalue {lowest[0]:.3g} with the diagonal"
            f" scaled to 1, most of it at dof {dof}): condense the dofs without mass, or give the"
            " mass matrix in full"
        )


def _require_stiffness(
    dofs: np.ndarray, mass: np.ndarray, stiffness: np.ndarray, name: str
) -> None:
    """Raise IndefiniteMatrixError if some motion has less strain energy than round-off.

    The sum of n products has an error of n epsilon times the sum of their absolute values at most:
    N. J. Higham, Accuracy and Stability of Numerical Algorithms (SIAM 2002), eq. 3.5. A lower sum
    shows that the matrix itself has a negative eigenvalue.
    """
    scale = 1.0 / np.sqrt(np.diag(mass))
    diagonal = np.diag(stiffness)
    scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), scale)
    _, vectors = linalg.eigh(stiffness * scale * scale[:, None], subset_by_index=[0, 0])
    motion = scale * vectors[:, 0]
    energy = float(motion @ stiffness @ motion)
    terms = float(np.abs(motion) @ np.abs(stiffness) @ np.abs(motion))
    if energy < -2 * len(dofs) * EPSILON * terms:
        square = energy / float(motion @ mass @ motion)
        raise IndefiniteMatrixError(
            f"{name}: has a negative eigenvalue, {square:.6g} rad²/s² or less"
            f" (-({np.sqrt(-square) / (2.0 * np.pi):.4g} Hz)², most of it at dof"
            f" {dofs[np.argmax(np.abs(vectors[:, 0]))]}): the structure runs away without a force;"
            " check the sign and the order of its rows, or, if it can move freely, write it with"
            " all digits"
        )
