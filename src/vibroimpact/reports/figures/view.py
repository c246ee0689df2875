"""The plane on which a structure is drawn, and what a reader sees of it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .style import PALE

OBLIQUE = (0.75, 0.45)  # how a unit away from the reader is seen: right and up
# The keywords of matplotlib for the line of a tube.
THICK_LINE = {"color": PALE, "linewidth": 5, "solid_capstyle": "butt", "zorder": 1}


@dataclass(frozen=True)
class View:
    """A view along a global axis; horizontal, vertical, depth: indices of the axes."""

    horizontal: int
    vertical: int
    depth: int

    @classmethod
    def of(cls, positions: np.ndarray) -> "View":
        """Return the View on the plane of the largest extents of positions (point, 3) in m."""
        depth = int(np.argmin(np.ptp(positions, axis=0)))
        horizontal, vertical = (axis for axis in range(3) if axis != depth)
        return cls(horizontal, vertical, depth)

    @property
    def towards(self) -> int:
        """1 if the depth axis points towards the reader, -1 if away.

        The global axes are right-handed: with x to the right and z up, y points away.
        """
        return 1 if (self.vertical - self.horizontal) % 3 == 1 else -1

    def seen(self, points: ArrayLike) -> np.ndarray:
        """Return points or directions (..., 3) in the plane, (..., 2)."""
        return np.asarray(points)[..., [self.horizontal, self.vertical]]

    def obliquely(self, points: ArrayLike) -> np.ndarray:
        """Return points (..., 3) in m as (..., 2), distant ones moved to the right and up."""
        away = -self.towards * np.asarray(points)[..., [self.depth]]
        return self.seen(points) + away * OBLIQUE

    def columns(self, points: ArrayLike) -> list[tuple[str, np.ndarray]]:
        """Return [(column, values (point,))] of points (point, 3) in m along both axes."""
        names = ("xyz"[axis] + "_m" for axis in (self.horizontal, self.vertical))
        return list(zip(names, np.atleast_2d(self.seen(points)).T, strict=True))
