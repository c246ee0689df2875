"""Positions of bars that press a structure at rest with a given force.

A flat land with the normal n presses a contact point with the force P. The contact yields by
p = P / k (or the inverse of Hertz' law), and the structure takes the displacement u at which it is
in equilibrium under the forces -P n of all preloaded lands and those of the other supports, which
may touch. The penetration n·(u - c) - g is p for every land of a point when its gap is g = -p and
its centre c = u. A bar on one side, with no other support touching, is the same as one with the
interference P / k + P n·C n, with C the static flexibility of the structure.
"""

from dataclasses import replace

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .batch import Schedule, settled

OUT_OF_REACH_M = 1.0e3


def seated(
    model: ModalModel, schedule: Schedule, gap: np.ndarray, imperfection: np.ndarray
) -> tuple[np.ndarray, np.ndarray | None]:
    """Return (offset (contact_point, 2, case) m, rest (mode, LANES)) of a model with preloads.

    offset: of the centres of the obstacles: the imperfection, and at points with a preload also the
        displacement of the structure at rest.
    rest: its modal amplitudes there, without constant forces; None if nothing is preloaded.

    gap (case,), imperfection (contact_point, 2, case): m, as of integrate_batch.
    """
    if not model.preload.any():
        return imperfection, None
    laws = model.contact_laws
    assembled = replace(
        model,
        constant_force=model.preload_force,
        contact_laws=laws.with_columns(gap=np.where(model.preload > 0.0, OUT_OF_REACH_M, laws.gap)),
    )
    rest = settled(assembled, schedule, gap, imperfection)
    moved = np.einsum("mpd,ml->pdl", model.contact_shapes, rest)[..., : np.size(gap)]
    return imperfection + np.where(model.preload[:, None, None] > 0.0, moved, 0.0), rest
