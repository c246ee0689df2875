"""Directions: unit vectors, and the two directions across a tube."""

import numpy as np
from numpy.typing import ArrayLike

ZERO_COMPONENT = 1.0e-13


def unit_vector(vector: ArrayLike) -> np.ndarray:
    """Return `vector` (3,) at length 1, with components below 1e-13 set to exactly 0.

    A rotation by 180 degrees leaves 1e-16 for a component that is 0. Exact zeros keep the planes of
    motion exactly uncoupled.
    Raises ValueError when the vector has length 0.
    """
    vector = np.asarray(vector, dtype=float)
    norm = np.linalg.norm(vector)
    if norm == 0.0:
        raise ValueError(
            "a direction of length 0 was given: give three components that are not all 0"
        )
    vector = vector / norm
    vector = np.where(np.abs(vector) < ZERO_COMPONENT, 0.0, vector)
    return vector / np.linalg.norm(vector)


def transverse_directions(tangent: np.ndarray) -> np.ndarray:
    """Return (2, 3), two unit vectors perpendicular to `tangent` (3,) and to each other.

    They are the two global axes least aligned with the tangent, in the order x, y, z, made
    perpendicular to it. A tangent along z gives exactly x and y. If two global axes are equally
    aligned, the later one is left out.
    """
    aligned = np.abs(tangent)
    left_out = int(np.flatnonzero(aligned > aligned.max() - 1.0e-9)[-1])
    return carried_directions(np.delete(np.eye(3), left_out, axis=0), tangent)


def carried_directions(directions: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Return (2, 3), transverse directions made perpendicular to another tangent (3,) near by.

    directions: (2, 3) unit vectors perpendicular to each other.
    """
    first = unit_vector(directions[0] - (directions[0] @ tangent) * tangent)
    second = directions[1] - (directions[1] @ tangent) * tangent
    return np.array([first, unit_vector(second - (second @ first) * first)])
