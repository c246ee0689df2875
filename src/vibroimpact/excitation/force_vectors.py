"""The places of the forces of a configuration: force vectors over the degrees of freedom."""

from collections.abc import Callable, Sequence

import numpy as np

from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.structure.point_structure import PointStructure
from vibroimpact.structure.tube import TubeStructure

# Points and weights of Gauss quadrature on -1 to 1.
GAUSS = (
    (-0.8611363115940526, 0.3478548451374538),
    (-0.3399810435848563, 0.6521451548625461),
    (0.3399810435848563, 0.6521451548625461),
    (0.8611363115940526, 0.3478548451374538),
)


def force_vector(
    structure: TubeStructure | PointStructure,
    point_rows: Callable[[str], np.ndarray],
    excitation: ConfigPart,
    axis: Sequence[float] | np.ndarray = (0.0, 0.0, 1.0),
) -> np.ndarray:
    """Return (dof,) the force on each degree of freedom per newton of the case's force.

    For base motion it is per m/s²; for no excitation it is zero.

    point_rows: function of a point's name that returns its displacement rows (3, dof).
    excitation: section of the configuration.
    axis: (3,), see turn_axis.
    """
    if excitation.kind == "none":
        return np.zeros(structure.dofs)
    if excitation.kind == "base_motion":
        inertia = structure.inertia
        if isinstance(structure, TubeStructure) and excitation.obstacles == "moving":
            inertia = inertia - structure.carried_inertia  # a fluid moves with its confinement
        return -unit_vector(excitation.direction) @ inertia
    direction = turned_direction(excitation.direction, excitation.turn_deg, axis)
    row = excitation.factor * (direction @ point_rows(excitation.point))
    for force in excitation.also:
        row = row + force.factor * (unit_vector(force.direction) @ point_rows(force.point))
    for load in excitation.distributed:
        row = row + load.factor_per_m * line_load(structure, load)
    return row


def turn_axis(config: ConfigPart, position: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return the unit vector (3,) about which the force at a position (3,) in m is turned.

    It is z, or the tangent of the tube there. Raises ValueError for the tangent of a structure
    other than a tube, or off it.
    """
    if getattr(config.excitation, "turn_about", "z") == "z" or config.excitation.turn_deg == 0.0:
        return np.array([0.0, 0.0, 1.0])
    if config.structure.kind not in TUBES:
        raise ValueError(
            "excitation.turn_about: tube needs a tube (structure.kind u_tube or path): use z"
        )
    centreline = build_centreline(config.structure)
    return centreline.direction(centreline.locate(position, "the force"))


def turned_direction(
    direction: Sequence[float] | np.ndarray,
    angle_deg: float,
    axis: Sequence[float] | np.ndarray = (0.0, 0.0, 1.0),
) -> np.ndarray:
    """Return the unit vector (3,) along a direction turned about an axis, right-handed.

    An angle of 0 leaves the bits of the direction unchanged.

    angle_deg: degrees.
    axis: (3,) unit vector.
    """
    vector = unit_vector(direction)
    if angle_deg == 0.0:
        return vector
    from scipy.spatial.transform import Rotation  # half a second that other runs save

    return Rotation.from_rotvec(np.deg2rad(angle_deg) * np.asarray(axis, float)).apply(vector)


def line_load(structure: TubeStructure | PointStructure, load: ConfigPart) -> np.ndarray:
    """Return (dof,) the consistent nodal force of 1 N/m between two places of the tube.

    It acts along load.direction, from load.from_m to load.to_m. Each stretch between nodes has four
    Gauss points. Raises ValueError when a place is off the tube or the structure is not a tube.
    """
    if not isinstance(structure, TubeStructure):
        raise ValueError(
            "excitation.distributed needs a tube (structure.kind u_tube or path): use"
            " excitation.also"
        )
    first, last = structure.centreline.stretch(load.from_m, load.to_m, "excitation.distributed")
    inner = structure.node_arc_length
    stretches = np.concatenate(
        [[first], inner[(inner > first + 1e-9) & (inner < last - 1e-9)], [last]]
    )
    row = np.zeros(structure.dofs)
    for begin, end in zip(stretches[:-1], stretches[1:], strict=True):
        half = 0.5 * (end - begin)
        for at, weight in GAUSS:
            rows = structure.displacement_rows(begin + half * (1.0 + at))
            row += weight * half * (unit_vector(load.direction) @ rows)
    return row


def constant_force_vector(
    structure: TubeStructure | PointStructure,
    point_rows: Callable[[str], np.ndarray],
    excitation: ConfigPart,
) -> np.ndarray:
    """Return (dof,) the constant force in N on each degree of freedom."""
    rows = [
        load.force_N * (unit_vector(load.direction) @ point_rows(load.point))
        for load in excitation.constant
    ]
    return np.sum(rows, axis=0) if rows else np.zeros(structure.dofs)
