"""The initial state of a structure in modal amplitudes, and the part that they can not represent.

A field over the degrees of freedom, u, has the amplitudes a = shapes^T M u. They are those of the
field nearest to it in kinetic energy, and the residual is |u - shapes a| / |u| in the norm of M.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.structure.rigid_motions import rigid_motion

# In the norm of the mass matrix. A residual of 0.05 is 0.25 % of the kinetic energy.
LARGEST_RESIDUAL = 0.05
# Motion of a held end, of the largest displacement of the field. If it does not vanish, the field
# is not one of this tube.
HELD_END = 1.0e-2
NO_MOTION = 1.0e-6  # of the largest motion of a point by a mode
AXES = "xyz"
KEYS = {
    "displacement": ("displacement_m", "translation_m", "rotation_rad", "amplitude_m"),
    "velocity": (
        "velocity_m_per_s",
        "translation_m_per_s",
        "rotation_rad_per_s",
        "amplitude_m_per_s",
    ),
}


def initial_state(
    structure: Any,
    shapes: np.ndarray,
    free_modes: int,
    initial: ConfigPart | None,
    point_rows: Callable[[str], np.ndarray],
) -> dict[str, np.ndarray]:
    """Return the fields of the initial state of a ModalModel.

    initial_displacement, initial_velocity: (mode,); initial_residual: (2,), of each, see the
        module.

    shapes: (dof, mode).
    free_modes: number of the first of them that are modes of the structure without contact.
    initial: section of the configuration.
    point_rows: function of a point's name that returns its displacement rows (3, dof).

    Raises ValueError when a field moves a held end, is not representable, or names a mode that is
    not there.
    """
    fields = {f"initial_{key}": np.zeros(shapes.shape[1]) for key in KEYS}
    residuals = np.zeros(2)
    for number, key in enumerate(KEYS if initial is not None else ()):
        field = getattr(initial, key)
        if field is None:
            wanted = _at_points(structure, initial, KEYS[key][0])
            fields[f"initial_{key}"] = shapes.T @ (structure.mass @ wanted)
        elif field.kind == "mode":
            fields[f"initial_{key}"] = _mode(shapes, free_modes, point_rows, key, field)
        else:
            wanted = _along_the_tube(structure, key, field)
            fields[f"initial_{key}"], residuals[number] = projected(structure.mass, shapes, wanted)
            if residuals[number] > LARGEST_RESIDUAL:
                raise ValueError(
                    f"initial.{key}: the modes represent the field with a residual of"
                    f" {residuals[number]:.3g} (at most {LARGEST_RESIDUAL}, in the norm of the"
                    " mass): raise basis.free_modes_to_Hz or give a smoother field"
                )
    return fields | {"initial_residual": residuals}


def projected(mass: Any, shapes: np.ndarray, field: np.ndarray) -> tuple[np.ndarray, float]:
    """Return (amplitudes (mode,), residual) of a field (dof,), see the module.

    mass: (dof, dof) sparse.
    shapes: (dof, mode), mass-orthonormal.
    """
    momentum = mass @ field
    amplitudes = shapes.T @ momentum
    left = field - shapes @ amplitudes
    size = float(field @ momentum)
    return amplitudes, float(np.sqrt(max(left @ (mass @ left), 0.0) / size)) if size else 0.0


def _at_points(structure: Any, initial: ConfigPart, key: str) -> np.ndarray:
    """Return (dof,) the field of values at named points of a structure other than a tube."""
    field = np.zeros(structure.dofs)
    for name, axes in getattr(initial, key).items():
        for axis, value in axes.items():
            if axis not in structure.directions.get(name, {}):
                raise ValueError(
                    f"initial.{key}.{name}.{axis}: the structure has no such point or direction"
                )
            field[structure.directions[name][axis]] = value
    return field


def _mode(
    shapes: np.ndarray, free_modes: int, point_rows: Callable, key: str, field: ConfigPart
) -> np.ndarray:
    """Return (mode,) amplitudes of one mode with the amplitude wanted at a point.

    free_modes: number of the first shapes that are modes of the structure without contact.
    """
    motion = point_rows(field.point)[AXES.index(field.direction)] @ shapes
    moving = np.flatnonzero(
        np.abs(motion[:free_modes]) > NO_MOTION * np.abs(motion).max(initial=0.0)
    )
    if field.number > len(moving):
        raise ValueError(
            f"initial.{key}.number = {field.number}: {len(moving)} modes move {field.point} along"
            f" {field.direction}: give at most that, or raise basis.free_modes_to_Hz"
        )
    chosen = moving[field.number - 1]
    amplitudes = np.zeros(shapes.shape[1])
    amplitudes[chosen] = getattr(field, KEYS[key][3]) / motion[chosen]
    return amplitudes


def _along_the_tube(structure: Any, key: str, field: ConfigPart) -> np.ndarray:
    """Return (dof,) a field of a tube, its nodes moved and turned as the field says.

    Raises ValueError if it moves an end that is held.
    """
    motion = (
        _rigid(structure, key, field) if field.kind == "rigid" else _spline(structure, key, field)
    )
    dofs = structure.transformation.T @ motion.ravel()
    lost = motion - (structure.transformation @ dofs).reshape(motion.shape)
    largest = np.linalg.norm(motion[:, :3], axis=1).max(initial=0.0)
    turned = structure.centreline.length * np.linalg.norm(lost[:, 3:], axis=1)
    moved = np.maximum(np.linalg.norm(lost[:, :3], axis=1), turned)
    if moved.max(initial=0.0) > HELD_END * largest:
        name = "start" if moved[0] >= moved[-1] else "end"
        raise ValueError(
            f"initial.{key}: the field moves or turns the {name} of the tube, which is held"
            f" there: give a field that is 0 there, or free the {name}"
        )
    return dofs


def _rigid(structure: Any, key: str, field: ConfigPart) -> np.ndarray:
    """Return (node, 6) a rigid-body field: displacements, then rotations."""
    _, translation, rotation, _ = KEYS[key]
    amounts = np.concatenate([getattr(field, translation), getattr(field, rotation)])
    return np.array(
        [rigid_motion(node - np.array(field.about_m)) @ amounts for node in structure.nodes]
    )


def _spline(structure: Any, key: str, field: ConfigPart) -> np.ndarray:
    """Return (node, 6) a field through values at places: displacements, then rotations.

    The sections turn with the centreline, t x du/ds, as those of a beam without shear.
    """
    line = structure.centreline
    places = np.array([line.locate(value.at_m, f"initial.{key}") for value in field.values])
    places[[0, -1]] = 0.0, line.length
    values = np.array([getattr(value, KEYS[key][0]) for value in field.values])
    rows = structure.transformation.tocsr()
    ends = tuple(  # an end that can not turn has no motion
        "not-a-knot" if end.nnz else (1, np.zeros(3)) for end in (rows[:6], rows[-6:])
    )
    from scipy.interpolate import CubicSpline  # half a second that others save

    spline = CubicSpline(places, values, bc_type=ends)
    tangents = np.array([line.direction(place) for place in structure.node_arc_length])
    turned = np.cross(tangents, spline(structure.node_arc_length, 1))
    return np.hstack([spline(structure.node_arc_length), turned])
