"""Local elements of a configuration, and damping that couples the modes.

Both become rows over the degrees of freedom, and laws.
"""

from collections.abc import Callable, Sequence

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.directions import unit_vector

from .laws import LocalLaws

COLUMNS = {
    "stiffness": "stiffness_N_per_m",
    "quadratic": "quadratic_N_per_m2",
    "cubic": "cubic_N_per_m3",
    "damping": "damping_N_s_per_m",
    "damping_limit": "damping_limit_N",
    "drag": "drag_N_s2_per_m2",
    "stick_stiffness": "stick_stiffness_N_per_m",
    "slip_limit": "slip_limit_N",
    "saturation_stiffness": "saturation_stiffness_N_per_m",
    "saturation_limit": "saturation_limit_N",
}
MOST_DAMPERS = 20
# Of the largest modal damping: a damping matrix whose other terms are below this is diagonal.
PROPORTIONAL = 1.0e-9


def element_rows(
    elements: Sequence[ConfigPart], point_rows: Callable[[str], np.ndarray], dofs: int
) -> np.ndarray:
    """Return (element, dof): the displacement of each element along its direction per unit dof.

    The displacement is relative if an element has two ends.

    elements: entries of the configuration.
    point_rows: function of a point's name that returns its displacement rows (3, dof).
    dofs: number of degrees of freedom.
    """
    rows = []
    for element in elements:
        other = point_rows(element.other_point) if element.other_point else 0.0
        rows.append(unit_vector(element.direction) @ (point_rows(element.point) - other))
    return np.array(rows).reshape(-1, dofs)


def element_laws(
    elements: Sequence[ConfigPart], dampers: Sequence[float] | np.ndarray = ()
) -> tuple[tuple[str, ...], LocalLaws]:
    """Return (names, LocalLaws) of local elements, followed by linear dampers.

    elements: entries of the configuration.
    dampers: (damper,) coefficients in N s/m.
    """
    names = tuple(element.name for element in elements) + tuple(
        f"damper_{number + 1}" for number in range(len(dampers))
    )
    columns = {
        column: np.array([getattr(element, key) for element in elements] + [0.0] * len(dampers))
        for column, key in COLUMNS.items()
    }
    columns["damping"][len(elements) :] = dampers
    index = {element.name: number for number, element in enumerate(elements)}
    columns["drag_partner"] = np.array(
        [index[element.drag_partner] if element.drag_partner else -1 for element in elements]
        + [-1] * len(dampers),
        np.int64,
    )
    return names, LocalLaws(**columns)


def split_damping(modal: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (diagonal (mode,), shapes (mode, damper), coefficients (damper,)) of a damping matrix.

    modal: (mode, mode), the damping matrix in modal coordinates. It equals diag(diagonal) plus the
        sum of coefficient shape shape^T over the dampers.

    A matrix that couples the modes becomes one damper per eigenvector, so that a local damper stays
    a single one. Raises ValueError when this takes more than MOST_DAMPERS.
    """
    diagonal = np.diag(modal).copy()
    coupling = np.abs(modal - np.diag(diagonal)).max(initial=0.0)
    if coupling <= PROPORTIONAL * np.abs(diagonal).max(initial=0.0):
        return diagonal, np.zeros((len(modal), 0)), np.zeros(0)
    coefficients, shapes = np.linalg.eigh(modal)
    significant = np.abs(coefficients) > PROPORTIONAL * np.abs(coefficients).max()
    if significant.sum() > MOST_DAMPERS:
        raise ValueError(
            f"structure.damping couples the modes through {significant.sum()} independent"
            f" dampers, at most {MOST_DAMPERS} are possible: give proportional damping (damping:"
            " rayleigh or modal) and the local dampers as elements"
        )
    return np.zeros(len(modal)), shapes[:, significant], coefficients[significant]
