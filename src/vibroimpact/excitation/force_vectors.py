"""Where the forces of a configuration act: rows over the degrees of freedom, and the mode that
carries a moving base.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from vibroimpact.config.name_checks import TUBES
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.directions import unit_vector

GAUSS = (
    (-0.8611363115940526, 0.3478548451374538),
    (-0.3399810435848563, 0.6521451548625461),
    (0.3399810435848563, 0.6521451548625461),
    (0.8611363115940526, 0.3478548451374538),
)
# Amplitude of the base mode per metre of base: contact forces move the base by this squared times
# what they move a kilogram.
BASE_SCALE = 1.0e-7


def force_row(structure, place, excitation, axis=(0.0, 0.0, 1.0)):
    """Return (dof,) the force on each degree of freedom per newton of the case's force (per m/s²
    for base motion; zeros for none).

    place: function name -> (3, dof) displacement rows of a named point; axis: see turn_axis.
    """
    if excitation.kind == "none":
        return np.zeros(structure.dofs)
    if excitation.kind == "base_motion":
        return -unit_vector(excitation.direction) @ structure.inertia
    row = excitation.factor * (
        turned(excitation.direction, excitation.turn_deg, axis) @ place(excitation.point)
    )
    for force in excitation.also:
        row = row + force.factor * (unit_vector(force.direction) @ place(force.point))
    for load in excitation.distributed:
        row = row + load.factor_per_m * line_load(structure, load)
    return row


def turn_axis(config, position):
    """Return the unit vector (3,) about which the force of a configuration at a position (3,) in m
    is turned: z, or the tube's tangent there.

    Raises ValueError for the tangent of a structure that is no tube, or off it.
    """
    if getattr(config.excitation, "turn_about", "z") == "z" or config.excitation.turn_deg == 0.0:
        return np.array([0.0, 0.0, 1.0])
    if config.structure.kind not in TUBES:
        raise ValueError(
            "excitation.turn_about: tube needs a tube (structure.kind u_tube or path): use z"
        )
    centreline = build_centreline(config.structure)
    return centreline.direction(centreline.locate(position, "the force"))


def turned(direction, angle_deg, axis=(0.0, 0.0, 1.0)):
    """Return the unit vector (3,) along a direction turned about an axis (unit vector) by an angle
    in degrees, right-handed; the same bits where the angle is 0.
    """
    vector = unit_vector(direction)
    if angle_deg == 0.0:
        return vector
    return Rotation.from_rotvec(np.deg2rad(angle_deg) * np.asarray(axis, float)).apply(vector)


def line_load(structure, load):
    """Return (dof,) the force of 1 N/m along load.direction between two places of the tube,
    consistent with its elements.

    Four Gauss points on each stretch between nodes. Raises ValueError when a place is off the tube
    or the structure is no tube.
    """
    if not hasattr(structure, "centreline"):
        raise ValueError(
            "excitation.distributed needs a tube (structure.kind u_tube or path): use"
            " excitation.also"
        )
    first, last = sorted(
        structure.centreline.locate(place, "excitation.distributed")
        for place in (load.from_m, load.to_m)
    )
    inner = structure.node_arc_length
    stretches = np.concatenate(
        [[first], inner[(inner > first + 1e-9) & (inner < last - 1e-9)], [last]]
    )
    row = np.zeros(structure.dofs)
    for begin, end in zip(stretches[:-1], stretches[1:], strict=True):
        half = 0.5 * (end - begin)
        for at, weight in GAUSS:
            row += (
                weight
                * half
                * (
                    unit_vector(load.direction)
                    @ structure.displacement_rows(begin + half * (1.0 + at))
                )
            )
    return row


def dead_load(structure, place, excitation):
    """Return (dof,) the constant force in N on each degree of freedom."""
    rows = [
        load.force_N * (unit_vector(load.direction) @ place(load.point))
        for load in excitation.constant
    ]
    return np.sum(rows, axis=0) if rows else np.zeros(structure.dofs)


def with_base_mode(fields, excitation, initial):
    """Return the fields of a ModalModel with one mode more in front: the motion of the base, seen
    by obstacles that stay in space.

    The mode has no stiffness; the case's acceleration drives it alone, and its share BASE_SCALE in
    the contact shapes turns relative displacements into absolute ones (the large mass method).
    fields: {name: array} with the mode axis first.
    """
    direction = unit_vector(excitation.direction)
    moved = fields["contact_directions"] @ direction  # (contact_point, 2)
    grown = dict(fields)
    for name in MODE_FIELDS:
        grown[name] = np.concatenate([np.zeros((1, *fields[name].shape[1:])), fields[name]])
    grown["contact_shapes"][0] = BASE_SCALE * moved
    grown["drive_shapes"][0, 0] = 1.0 / BASE_SCALE
    if initial is not None:
        grown["initial_displacement"][0] = initial.base_displacement_m / BASE_SCALE
        grown["initial_velocity"][0] = initial.base_velocity_m_per_s / BASE_SCALE
    return grown


MODE_FIELDS = (
    "omega",
    "damping",
    "contact_shapes",
    "drive_shapes",
    "sensor_shapes",
    "line_shapes",
    "stress_shapes",
    "element_shapes",
    "initial_displacement",
    "initial_velocity",
    "constant_force",
)
