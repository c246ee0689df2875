"""The local elements of a configuration, and damping that the modes do not uncouple, as rows over
the degrees of freedom and laws.
"""

import numpy as np

from vibroimpact.geometry.directions import unit_vector

from .laws import LocalLaws

COLUMNS = {
    "stiffness": "stiffness_N_per_m",
    "quadratic": "quadratic_N_per_m2",
    "cubic": "cubic_N_per_m3",
    "damping": "damping_N_s_per_m",
    "drag": "drag_N_s2_per_m2",
    "stick_stiffness": "stick_stiffness_N_per_m",
    "slip_limit": "slip_limit_N",
    "saturation_stiffness": "saturation_stiffness_N_per_m",
    "saturation_limit": "saturation_limit_N",
}
MOST_DAMPERS = 20
PROPORTIONAL = 1.0e-9  # of the largest modal damping: below it a damping matrix counts as diagonal


def element_rows(elements, place, dofs):
    """Return (element, dof): displacement of each element along its direction, relative where it
    has two ends.
    """
    rows = [
        unit_vector(element.direction)
        @ (place(element.point) - (place(element.other_point) if element.other_point else 0.0))
        for element in elements
    ]
    return np.array(rows).reshape(-1, dofs)


def element_laws(elements, dampers=()):
    """Return (names, LocalLaws) of `elements` (config entries), then of linear dampers
    (coefficient,) N s/m.
    """
    names = tuple(element.name for element in elements) + tuple(
        f"damper_{number + 1}" for number in range(len(dampers))
    )
    columns = {
        column: np.array([getattr(element, key) for element in elements] + [0.0] * len(dampers))
        for column, key in COLUMNS.items()
    }
    columns["damping"][len(elements) :] = dampers
    own = {element.name: number for number, element in enumerate(elements)}
    columns["drag_partner"] = np.array(
        [own[element.drag_partner] if element.drag_partner else -1 for element in elements]
        + [-1] * len(dampers),
        np.int64,
    )
    return names, LocalLaws(**columns)


def split_damping(modal):
    """Return (diagonal (mode,), shapes (mode, damper), coefficients (damper,)) with modal = diag +
    sum of coefficient shape shape^T.

    modal (mode, mode): a damping matrix in modal coordinates. What the modes do not uncouple
    becomes dampers, one per eigenvector of the whole matrix where it has few, so that a local
    damper stays one. Raises ValueError when it takes more than MOST_DAMPERS.
    """
    diagonal = np.diag(modal).copy()
    if np.abs(modal - np.diag(diagonal)).max(initial=0.0) <= PROPORTIONAL * np.abs(diagonal).max(
        initial=0.0
    ):
        return diagonal, np.zeros((len(modal), 0)), np.zeros(0)
    coefficients, shapes = np.linalg.eigh(modal)
    kept = np.abs(coefficients) > PROPORTIONAL * np.abs(coefficients).max()
    if kept.sum() > MOST_DAMPERS:
        raise ValueError(
            f"structure.damping couples the modes through {kept.sum()} independent dampers, at most"
            f" {MOST_DAMPERS} can be kept: give proportional damping (damping: rayleigh or modal)"
            " and the local dampers as elements"
        )
    return np.zeros(len(modal)), shapes[:, kept], coefficients[kept]
