"""Depth of wear in a round tube, from the volume that is worn away.

Over the length L of the contact a volume takes an area of the cross-section,

- against a flat bar, a segment of the tube's circle,
- against a bore, the crescent of the tube's circle that lies outside that of the bore.

At a tilt theta the depth falls by theta per length from one edge of the contact: the volume is the
integral of the area. A shallow flat at d <= L theta has d = (2R)^(-1/5) (15 theta V / 8)^(2/5). If
the support wears too, the tube has V_t of the worn V_w, and V_t / V_w of the depth.

Source: code_aster R7.04.10 (usuvus, usupru), whose flats are approximations of the segment.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

YEAR_S = 365.25 * 86400.0
NODES, WEIGHTS = np.polynomial.legendre.leggauss(32)  # of the integral along a tilted contact


@dataclass(frozen=True)
class WornShape:
    """The shape that a support wears into a tube.

    length, radius: of the contact and of the tube, m. bore: radius of the hole, m, infinite for a
    flat bar. tilt: of the support on the tube's axis, rad. tube_share: of the worn volume.
    """

    length: float
    radius: float
    bore: float = np.inf
    tilt: float = 0.0
    tube_share: float = 1.0


def segment_area(depth: np.ndarray | float, radius: float) -> np.ndarray:
    """Return the area in m² that a flat bar takes from a circle, to depths in m."""
    share = 1.0 - np.asarray(depth) / radius
    return radius**2 * (np.arccos(share) - share * np.sqrt(1.0 - share**2))


def crescent_area(depth: np.ndarray | float, radius: float, bore: float) -> np.ndarray:
    """Return the area in m² of a circle that lies outside a larger one, to depths in m.

    radius, bore: m. They touch from inside at depth 0.
    """
    apart = bore - radius + np.asarray(depth)
    along = (apart**2 + radius**2 - bore**2) / (2.0 * apart)
    own = np.arccos(np.clip(along / radius, -1.0, 1.0))
    other = np.arccos(np.clip((apart - along) / bore, -1.0, 1.0))
    lens = radius**2 * (own - 0.5 * np.sin(2.0 * own))
    lens += bore**2 * (other - 0.5 * np.sin(2.0 * other))
    return np.pi * radius**2 - lens


def volume_of(depth: np.ndarray | float, shape: WornShape) -> np.ndarray:
    """Return the volumes in m³ worn off the tube at depths in m, no deeper than the radius."""
    deep = np.minimum(np.asarray(depth, dtype=float) / shape.tube_share, shape.radius)
    if shape.tilt == 0.0:
        return shape.tube_share * shape.length * _area(deep, shape)
    reach = np.minimum(shape.length, deep / shape.tilt)  # length that is worn
    along = 0.5 * reach[..., None] * (1.0 + NODES)
    areas = _area(deep[..., None] - shape.tilt * along, shape)
    return shape.tube_share * 0.5 * reach * (areas @ WEIGHTS)


def depth_of(volume: float, shape: WornShape) -> float:
    """Return the depth in m of a volume in m³ worn off the tube; the inverse of volume_of."""
    deepest = shape.tube_share * shape.radius
    if volume >= volume_of(deepest, shape):
        return deepest
    return float(
        brentq(
            lambda depth: float(volume_of(depth, shape)) - volume,
            0.0,
            deepest,
            xtol=1e-12 * shape.radius,
        )
    )


def _area(depth: np.ndarray, shape: WornShape) -> np.ndarray:
    """Return the areas in m² at depths in m."""
    if np.isfinite(shape.bore):
        return crescent_area(depth, shape.radius, shape.bore)
    return segment_area(depth, shape.radius)
