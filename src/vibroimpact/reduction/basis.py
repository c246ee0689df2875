"""The basis of a structure, and the variants of the structure that it serves."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse


@dataclass(frozen=True, eq=False)
class Basis:
    """The basis of a reduction: omega (mode,) rad/s and shapes (dof, mode) of a structure."""

    structure: Any
    omega: np.ndarray
    shapes: np.ndarray

    @property
    def nodes(self) -> np.ndarray | None:
        """Return the arc lengths (node,) in m of the nodes of a tube, None of another structure."""
        return getattr(self.structure, "node_arc_length", None)

    def shapes_of(self, variant: Any) -> np.ndarray | None:
        """Return shapes (dof, vector) that span the motion of a variant on the same mesh, None if
        they may not. If clamps of its ends give way, the static shapes of forces there are added
        (R. R. Craig and M. C. C. Bampton, AIAA Journal 6 (1968) 1313-1319).
        """
        own = self.structure
        if self.nodes is None or np.array_equal(own.end_springs, variant.end_springs):
            return self.shapes if len(self.shapes) == variant.dofs else None
        place = (variant.transformation.T @ own.transformation).tocsr()  # (dof, dof of the basis)
        freed = np.flatnonzero(np.diff(place.indptr) == 0)
        sprung = np.flatnonzero(variant.end_springs)
        if own.dofs + len(freed) != variant.dofs or not np.array_equal(freed, sprung):
            return None
        force = sparse.eye_array(variant.dofs, format="csc")[:, freed].toarray()
        static = sparse.linalg.splu(variant.stiffness.tocsc()).solve(force)
        return np.hstack([place @ self.shapes, static / np.abs(static).max(axis=0)])
