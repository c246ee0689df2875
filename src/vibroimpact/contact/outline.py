"""The outline of the space in which the centre of a tube moves freely inside its support."""

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart

from .profiles import land_normals, lobes

ROUND_POINTS = 361  # points of a round outline, once per degree


def support_outline(
    support: ConfigPart, gap_m: float, directions: np.ndarray, extent_m: float, pair: int = 0
) -> np.ndarray:
    """Return (point, 2) m, the closed outline of the free space at a contact point of a support.

    Coordinates are along the two transverse directions, from the tube at rest: the tube is free
    where its centre is inside. The first point is repeated at the end. Empty where bars on opposite
    sides press, so that no place is free.

    support: entry of the configuration. Its first centre_offset_m is used; a preload is drawn as
        the gap given.
    gap_m: gap at the point; that of the case, or gap_m of the support.
    directions: (2, 3) transverse directions at the contact point, see ContactPoints.
    extent_m: half the side of the square that an open profile, such as one bar, is cut to.
    pair: 1 for the second pair of bars of a lattice with spacing_m.
    """
    centre = np.reshape(support.centre_offset_m, (-1, 2))[0]
    normals = land_normals(support.profile, directions, pair)
    if len(normals):
        return flat_outline(normals, gap_m, extent_m, centre)
    return round_outline(gap_m, *lobes(support.profile, directions)) + centre


def round_outline(gap_m: float, count: int, depth_m: float, angle: float) -> np.ndarray:
    """Return (point, 2) m on r(theta) = gap + depth (1 - cos(count (theta - angle))) / 2.

    angle: rad.
    """
    theta = np.linspace(0.0, 2.0 * np.pi, ROUND_POINTS)
    radius = gap_m + 0.5 * depth_m * (1.0 - np.cos(count * (theta - angle)))
    return radius[:, None] * np.column_stack([np.cos(theta), np.sin(theta)])


def flat_outline(
    normals: np.ndarray, gap_m: float, extent_m: float, centre: np.ndarray
) -> np.ndarray:
    """Return (point, 2) m, the corners of {d: n·(d - centre) <= gap for all n} in a square.

    A polygon, the square, is cut with one half-plane after the other (Sutherland and Hodgman,
    Reentrant polygon clipping, Communications of the ACM 17 (1974) 32-42).

    normals: (land, 2) unit vectors.
    extent_m: half the side of the square, whose middle is the tube at rest.
    centre: (2,) m.
    """
    corners = extent_m * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    for normal in normals:
        room = gap_m - (corners - centre) @ normal
        kept = []
        for number, (here, left) in enumerate(zip(corners, room, strict=True)):
            before, left_before = corners[number - 1], room[number - 1]
            if left * left_before < 0.0:  # the edge to this corner crosses the land
                kept.append(before + (here - before) * left_before / (left_before - left))
            if left >= 0.0:
                kept.append(here)
        if not kept:
            return np.zeros((0, 2))
        corners = np.array(kept)
    return np.vstack([corners, corners[:1]])
