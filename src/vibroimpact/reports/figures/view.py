"""The plane on which a structure is drawn, what a reader sees of it, and labels beside the things
that they name, without overlap.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from numpy.typing import ArrayLike

from .style import PALE, tidy_log_axes

OBLIQUE = (0.75, 0.45)  # how a unit away from the reader is seen: right and up
# The keywords of matplotlib for the line of a tube.
THICK_LINE = {"color": PALE, "linewidth": 5, "solid_capstyle": "butt", "zorder": 1}
CLEAR_PX = 2.0  # between two labels, at the resolution of the figure


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


def spread_labels(figure: Figure, labels: Sequence[Annotation]) -> None:
    """Move labels up or down until none covers another; a moved one gets a thin line to its place.

    labels: annotations of a figure whose places are offsets in points.

    The highest stays, the others move down; if that leads below the axes, all move up again.
    """
    if len(labels) < 2:
        return
    if not hasattr(figure.canvas, "get_renderer"):
        FigureCanvasAgg(figure)
    tidy_log_axes(figure)
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    boxes = {label: label.get_window_extent(renderer) for label in labels}
    moves: dict[Annotation, float] = {}
    for label in sorted(labels, key=lambda each: -boxes[each].y1):
        moves[label] = min(0.0, _free_top(boxes, moves, label) - boxes[label].y1)
    _raise_above_the_axes(boxes, moves)
    for label, pixels in moves.items():
        if abs(pixels) > 1.0:
            x, y = label.get_position()
            label.set_position((x, y + pixels * 72.0 / figure.dpi))


def _free_top(boxes, moves, label):
    """Return the highest top in pixels that a label may have below those that are placed."""
    box, top = boxes[label], boxes[label].y1
    for other, move in sorted(moves.items(), key=lambda item: -(boxes[item[0]].y1 + item[1])):
        beside = boxes[other].x1 + CLEAR_PX < box.x0 or box.x1 + CLEAR_PX < boxes[other].x0
        low, high = boxes[other].y0 + move - CLEAR_PX, boxes[other].y1 + move
        if not beside and top > low and top - box.height < high:
            top = low
    return top


def _raise_above_the_axes(boxes, moves):
    """Move the lowest labels up to the bottom of their axes, and those that they then meet."""
    floors = {}
    for label in sorted(boxes, key=lambda each: boxes[each].y0 + moves[each]):
        box = boxes[label]
        floor = label.axes.get_window_extent().y0
        for (left, right), high in floors.items():
            if not (right + CLEAR_PX < box.x0 or box.x1 + CLEAR_PX < left):
                floor = max(floor, high + CLEAR_PX)
        moves[label] += max(0.0, floor - (box.y0 + moves[label]))
        floors[box.x0, box.x1] = box.y1 + moves[label]
