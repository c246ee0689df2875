"""Secant stiffness of a simulated record, from the contact forces themselves."""

import numpy as np


def secant_stiffness(
    force_displacement: np.ndarray,
    displacement_square: np.ndarray,
    weight: np.ndarray,
    support: np.ndarray,
) -> tuple[float, float]:
    """Return (k in N/m per support, its standard error): E[f u] / E[u²] over a record.

    Both means are summed over the points of a support. Only the direction with the larger motion
    counts; the forces of the other belong to another motion. The standard error is the scatter over
    the supports, NaN for a single one.

    force_displacement: (contact_point, direction) mean of force times displacement in N m.
    displacement_square: (contact_point, direction) m².
    weight: (contact_point,) share of the support's stiffness.
    support: (contact_point,) number of the support.
    """
    direction = int(np.argmax(displacement_square.sum(axis=0)))
    work = np.bincount(support, force_displacement[:, direction])
    square = np.bincount(support, weight * displacement_square[:, direction])
    each = work / square
    error = np.std(each, ddof=1) / np.sqrt(each.size) if each.size > 1 else np.nan
    return float(work.sum() / square.sum()), float(error)
