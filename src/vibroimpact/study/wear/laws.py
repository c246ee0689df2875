"""The laws of wear, the volume that a work rate wears away in a time, and the depth of that volume
in a round tube.

Over the length L of the contact a volume takes an area of the cross-section,

- against a flat bar, a segment of the circle of the tube,
- against a bore, the crescent of that circle that lies outside that of the bore.

At a tilt theta the depth falls by theta per length from one edge of the contact: the volume is the
integral of the area. A shallow flat at d <= L theta has d = (2R)^(-1/5) (15 theta V / 8)^(2/5). If
the support wears too, the tube has V_t of the worn V_w, and V_t / V_w of the depth.

Source: code_aster R7.04.10, POST_USURE (usupru, usuvus), whose flats are approximations of the
segment, and its coefficients (usuban).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

HALVINGS = 60  # of the interval that holds a time
YEAR_S = 365.25 * 86400.0
NODES, WEIGHTS = np.polynomial.legendre.leggauss(32)  # of the integral along a tilted contact


@dataclass(frozen=True)
class Archard:
    """Archard's law V = K P t. name: such as a pair of materials. coefficient: K, m²/N."""

    coefficient: float
    name: str = "K"

    def seconds(self, volume: np.ndarray, power: np.ndarray) -> np.ndarray:
        """Return the times in s in which powers in W wear volumes in m³ away, inf without power."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(volume > 0.0, volume / (self.coefficient * power), 0.0)


@dataclass(frozen=True)
class EdfMz:
    """The slowing law EDF_MZ: V = A P^B [x t + (1 - x) (1 - exp(-N t)) / N] with x = S / (A P^B).

    initial, exponent: A and B, in W and s. slowing: N, 1/s. final_rate: S, m³/s. Below about
    3.5 mW the law would speed up, x > 1: x is then 1, a departure from the source.
    """

    initial: float = 1e-13
    exponent: float = 1.2
    slowing: float = 2.44e-8
    final_rate: float = 1.14e-16
    name: str = "EDF_MZ"
    coefficient = None

    def seconds(self, volume: np.ndarray, power: np.ndarray) -> np.ndarray:
        """Return the times in s in which powers in W wear volumes in m³ away, inf without power."""
        rate = self.initial * np.asarray(power, dtype=float) ** self.exponent
        final = self.final_rate / np.maximum(rate, self.final_rate)  # x
        with np.errstate(divide="ignore", invalid="ignore"):
            wanted = np.where(volume > 0.0, volume / rate, 0.0)
        # x t is below the bracket, and t above it.
        low, high = wanted, wanted / final
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            decay = -np.expm1(-self.slowing * middle) / self.slowing
            late = final * middle + (1.0 - final) * decay > wanted
            low, high = np.where(late, low, middle), np.where(late, middle, high)
        return 0.5 * (low + high)


WearLaw = Archard | EdfMz

# Coefficients K of pairs of materials, tube over support, by the shape of the support. m²/N.
PAIRS = {
    "bars": {"I600/I600": 1.2e-13, "I600/405": 6.2e-14, "I690/405": 4.1e-16, "I690/Z6C13": 7.7e-15},
    "quadrifoil": {"I600/405": 6.5e-14, "I600TT/405": 1.4e-15, "I690/405": 7.8e-15},
    "drilled": {"I690/I600": 5.2e-14},
}


def published_laws(shape: str) -> Sequence[Archard]:
    """Return Archard's law of each pair of PAIRS for a shape; of all shapes if it has one pair.

    One test of one pair is not a range.
    """
    shapes = [shape] if len(PAIRS[shape]) > 1 else list(PAIRS)
    return [Archard(k, f"{name}, {pair}") for name in shapes for pair, k in PAIRS[name].items()]


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
