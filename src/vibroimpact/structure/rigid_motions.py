"""The rigid-body motions that the ends of a tube leave free."""

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import Centreline

INDEPENDENT = 1.0e-9  # singular values of the conditions below this are 0


def rigid_motion(position: np.ndarray) -> np.ndarray:
    """Return (6, 6): displacement and rotation of a point per unit rigid-body motion.

    Rows are ux, uy, uz, rx, ry, rz; columns the translations along x, y, z and the rotations about
    x, y, z through the origin: u = t + w x p.

    position: (3,) p, in any unit of length.
    """
    x, y, z = position
    cross = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])  # w x p = cross @ w
    return np.block([[np.eye(3), cross], [np.zeros((3, 3)), np.eye(3)]])


def free_rigid_motions(structure: ConfigPart, centreline: Centreline) -> int:
    """Return the number of independent rigid-body motions of a tube that its ends do not resist.

    A clamped end and one on springs resist all six; a pinned end resists the displacement and the
    rotation about the tube.

    structure: section of the configuration, of kind u_tube or path.
    """
    if structure.kind == "u_tube":
        kinds = (structure.root.kind, structure.root.kind)
    else:
        kinds = (structure.start.kind, structure.end.kind)
    conditions = [np.zeros((0, 6))]
    for kind, place in zip(kinds, (0.0, centreline.length), strict=True):
        motion = rigid_motion(centreline.position(place) / centreline.length)
        if kind == "pinned":
            motion = np.vstack([motion[:3], centreline.direction(place) @ motion[3:]])
        if kind != "free":
            conditions.append(motion)
    sizes = np.linalg.svd(np.vstack(conditions), compute_uv=False)
    return 6 - int(np.sum(sizes > INDEPENDENT))
