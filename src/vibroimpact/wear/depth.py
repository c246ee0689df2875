"""Depth of wear in a round tube, from the volume that is worn away.

Archard's law with the work rate P (normal force times sliding speed): V = K P t. Over the length L
of the contact it takes an area of the cross-section,

- against a flat bar, a segment of the tube's circle,
- against a bore, the crescent of the tube's circle that lies outside that of the bore.

Source: code_aster R7.04.10 (usuvus, usupru), whose flat bar is an approximation of the segment.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

YEAR_S = 365.25 * 86400.0


def segment_area(depth: float, radius: float) -> float:
    """Return the area in m² that a flat bar takes from a circle, to a depth in m."""
    share = 1.0 - depth / radius
    return float(radius**2 * (np.arccos(share) - share * np.sqrt(1.0 - share**2)))


def crescent_area(depth: float, radius: float, bore: float) -> float:
    """Return the area in m² of a circle that lies outside a larger one, to a depth in m.

    radius, bore: m. They touch from inside at depth 0.
    """
    apart = bore - radius + depth
    along = (apart**2 + radius**2 - bore**2) / (2.0 * apart)
    own = np.arccos(np.clip(along / radius, -1.0, 1.0))
    other = np.arccos(np.clip((apart - along) / bore, -1.0, 1.0))
    lens = radius**2 * (own - 0.5 * np.sin(2.0 * own))
    lens += bore**2 * (other - 0.5 * np.sin(2.0 * other))
    return float(np.pi * radius**2 - lens)


def depth_of(volume: float, length: float, radius: float, bore: float = np.inf) -> float:
    """Return the depth in m of a volume in m³ over a length in m, no more than the radius.

    bore: radius of the hole that wears the tube, infinite for a flat bar.
    """
    area = _area(radius, bore)
    wanted = volume / length
    if wanted >= area(radius):
        return radius
    return float(brentq(lambda depth: area(depth) - wanted, 0.0, radius, xtol=1e-12 * radius))


def volume_of(depth: float, length: float, radius: float, bore: float = np.inf) -> float:
    """Return the volume in m³ at a depth in m; the inverse of depth_of."""
    return length * _area(radius, bore)(min(depth, radius))


def _area(radius: float, bore: float) -> Callable[[float], float]:
    """Return the area of a depth, for a flat bar or a bore."""
    if np.isfinite(bore):
        return lambda depth: crescent_area(depth, radius, bore)
    return lambda depth: segment_area(depth, radius)
