"""The smallest change of several supports that gives the structure a measured pole.

A pole is two numbers and cannot fix more than one stiffness and damping. It moves the supports that
another method found, as little as their covariance allows, until the main mode has the pole. With
one support this gives the support of the pole itself, wherever it starts.
"""

import numpy as np

from vibroimpact.identify.linear.poles import frequency_of, pole_of
from vibroimpact.identify.linear.supported_structure import SupportedStructure

from .support_fit import FoundSupports

PASSES = 8
LARGEST_CHANGE = 0.7  # of ln k in one pass
SETTLED = 1.0e-8


def step_to_pole(
    structure: SupportedStructure, found: FoundSupports, pole: tuple[float, float, np.ndarray]
) -> FoundSupports | None:
    """Return the nearest supports that give the main mode a pole, or None if there are none.

    found: that the step begins at; only the shape of its covariance matters for the step.
    pole: frequency in Hz, damping ratio, and their covariance (2, 2).
    """
    k, c, covariance = found.k, found.c, found.covariance
    frequency, ratio, scatter = pole
    wanted = np.array([frequency, ratio])
    count, start = len(k), np.concatenate([np.log(k), c])
    values = start.copy()
    for _ in range(PASSES):
        has, slope = _pole_slope(structure, np.exp(values[:count]), values[count:], *wanted)
        gain = _gain(slope, covariance)
        if gain is None:
            return None
        change = start + gain @ (wanted - has - slope @ (start - values)) - values
        change *= min(1.0, LARGEST_CHANGE / max(np.abs(change[:count]).max(), 1.0e-12))
        values = values + change
        if not np.all(np.isfinite(values)):
            return None
        if np.abs(change[:count]).max() < SETTLED:
            break
    has, slope = _pole_slope(structure, np.exp(values[:count]), values[count:], *wanted)
    gain = _gain(slope, covariance)
    if gain is None or np.any(np.abs(has / wanted - 1.0) > (1.0e-3, 0.05)):
        return None
    keep = np.eye(2 * count) - gain @ slope
    total = keep @ covariance @ keep.T + gain @ scatter @ gain.T
    return FoundSupports(np.exp(values[:count]), values[count:], total, gain[:, 0] * frequency)


def _gain(slope: np.ndarray, covariance: np.ndarray) -> np.ndarray | None:
    """Return (2 direction, 2) the change of the supports per change of the pole, or None."""
    seen = slope @ covariance @ slope.T
    scale = np.sqrt(np.diag(seen))
    if not np.all(scale > 0.0) or np.linalg.cond(seen / np.outer(scale, scale)) > 1.0e10:
        return None
    return covariance @ slope.T @ np.linalg.inv(seen)


def _pole_slope(
    structure: SupportedStructure, k: np.ndarray, c: np.ndarray, frequency: float, ratio: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return ((frequency in Hz, damping ratio), their derivatives (2, 2 direction) by ln k and c).

    They belong to the pole nearest to that of the frequency and damping ratio given.
    """
    pole, by_k = structure.pole(k, c, pole_of(frequency, ratio))
    change = np.concatenate([by_k * k, pole * by_k])
    size = abs(pole)
    by_size = (pole.conjugate() * change).real / size
    by_ratio = -change.real / size + pole.real * by_size / size**2
    return np.array(frequency_of(pole)), np.array([by_size / (2.0 * np.pi), by_ratio])
