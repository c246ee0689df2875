"""The nodes of the finite-element mesh along a centreline."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .centreline import SAME_PLACE_M, Centreline

# Least length of an element, of that of a segment in elements_per_span. The bending stiffness of an
# element grows with its length to the power -3 and takes its round-off along: the elements of a
# 1 mm stretch beside a free end must not be 0.05 mm long.
SHORTEST_ELEMENT = 0.02


def mesh_arc_lengths(
    centreline: Centreline, mesh: Any, supports: Sequence[np.ndarray]
) -> np.ndarray:
    """Return (node,) arc lengths in m of the mesh nodes, ascending.

    mesh: the section structure.mesh of a configuration.
    supports: one (contact_point,) array of arc lengths in m per support.

    Segment ends and contact points are nodes. Neighbouring contact points of a support are joined
    by one element. A stretch of a straight segment between supports or segment ends has
    elements_per_span elements, or fewer if they would be shorter than SHORTEST_ELEMENT. A whole
    bend has elements_per_bend; if supports cut it, its parts share them by length.
    """
    fixed = [
        0.0,
        *(piece.end for piece in centreline.segments),
        *(place for points in supports for place in points),
    ]
    breaks = [0.0]
    for place in sorted(fixed):
        if place - breaks[-1] > SAME_PLACE_M:
            breaks.append(place)
    nodes = [0.0]
    for left, right in zip(breaks[:-1], breaks[1:], strict=True):
        count = _elements_between(centreline, mesh, supports, left, right)
        nodes.extend(left + (right - left) * np.arange(1, count) / count)
        nodes.append(right)
    return np.array(nodes)


def halved_mesh(nodes: np.ndarray) -> np.ndarray:
    """Return (2 node - 1,) arc lengths in m of a mesh whose elements are cut in two.

    nodes: (node,) m, ascending.
    """
    return np.interp(np.arange(2 * len(nodes) - 1) / 2, np.arange(len(nodes)), nodes)


def _elements_between(
    centreline: Centreline, mesh: Any, supports: Sequence[np.ndarray], left: float, right: float
) -> int:
    """Return the number of elements of the stretch from `left` to `right` (arc lengths in m)."""
    if any(
        points[0] < right - SAME_PLACE_M and left + SAME_PLACE_M < points[-1] for points in supports
    ):
        return 1
    segment = centreline.segment_at(0.5 * (left + right))
    if segment.toward is None:
        shortest = SHORTEST_ELEMENT * segment.length / mesh.elements_per_span
        return max(1, min(mesh.elements_per_span, int((right - left) / shortest)))
    return max(1, int(np.ceil(mesh.elements_per_bend * (right - left) / segment.length - 1.0e-6)))
