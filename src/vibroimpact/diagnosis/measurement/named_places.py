"""The places of channels and forces on a structure that is known at named points only: matrices, a
chain, or measured modes.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from vibroimpact.geometry.centreline import LOCATION_TOLERANCE_M
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.structure.point_structure import AXES, PointStructure

LEAST_COSINE = 0.1  # between a sensor and a direction that it measures


def point_at(
    points: Mapping[str, Sequence[float]], place: Sequence[float] | np.ndarray, what: str
) -> str:
    """Return the name of the point at a place (3,) in m; points: {name: (3,)} m. what: the channel
    or force there. Raises ValueError when every point is more than 5 mm away.
    """
    place = np.asarray(place, float)
    away = {name: float(np.linalg.norm(place - at)) for name, at in points.items()}
    nearest = min(away, key=lambda name: away[name])
    if away[nearest] > LOCATION_TOLERANCE_M:
        raise ValueError(
            f"{what} at {place.tolist()} m is {away[nearest]:.4f} m from the nearest named point,"
            f" {nearest} at {list(points[nearest])} m (limit {LOCATION_TOLERANCE_M} m): name the"
            " point of the structure that is there"
        )
    return nearest


def no_motion(
    structure: PointStructure,
    points: Mapping[str, Sequence[float]],
    place: np.ndarray,
    direction: np.ndarray,
) -> str:
    """Return the direction and point, in words, at which a structure does not move; empty if it
    does, or if there is no point; see point_at. direction (3,): of a channel or a force there.
    """
    try:
        point, along = point_at(points, place, "it"), unit_vector(direction)
    except ValueError:
        return ""
    axes = [AXES[axis] for axis in structure.directions.get(point, ())]
    if np.linalg.norm(along[axes]) >= LEAST_COSINE:
        return ""
    return f"along {along.round(3).tolist()} at {point}, where the structure has no such motion"
