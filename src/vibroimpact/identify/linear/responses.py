"""Frequency responses of the linear tube on a support (k, c).

The support's dynamic stiffness is s = k + i omega c. With the tube without support known at the
contacts, its response follows from a small linear system in the contact forces:

    h = h_free - a^T s (I + s G)^-1 b

G: contact compliance, b: contact displacement per unit drive, a: output per unit contact force.
"""

from collections.abc import Sequence

import numpy as np

from vibroimpact.io.units import TIME_DERIVATIVES
from vibroimpact.reduction.modal_model import ModalModel

from .modes import contact_matrix, transfer

FREQUENCY_CHUNK = 4096


def frf(
    model: ModalModel,
    k: float,
    c: float,
    frequency: np.ndarray | Sequence[float] | float,
    output_shapes: np.ndarray,
    kind: str = "displacement",
    channel: int = 0,
) -> np.ndarray:
    """Return (output, frequency) complex response per N of a force channel.

    k, c: stiffness in N/m and damping in N s/m of the support.
    frequency: (frequency,) Hz.
    output_shapes: (mode, output).
    kind: displacement (m), velocity (m/s) or acceleration (m/s²).
    channel: number of the force channel.
    """
    driven = [
        modes for modes, _ in model.blocks if np.any(model.drive_shapes[modes, channel] != 0.0)
    ]
    modes = np.sort(np.concatenate(driven)) if driven else np.zeros(0, dtype=int)
    contact = contact_matrix(model)[modes]
    contact = contact[:, (contact != 0.0).any(axis=0)]
    drive, outputs = model.drive_shapes[modes, channel][:, None], output_shapes[modes]
    frequency = np.atleast_1d(np.asarray(frequency, dtype=float))
    response = np.empty((output_shapes.shape[1], len(frequency)), dtype=complex)
    for first in range(0, len(frequency), FREQUENCY_CHUNK):
        part = slice(first, first + FREQUENCY_CHUNK)
        laplace = 2j * np.pi * frequency[part]
        column = laplace[:, None]
        receptance = 1.0 / (column**2 + column * model.damping[modes] + model.omega[modes] ** 2)
        compliance = transfer(receptance, contact, contact)
        support = (k + laplace * c)[:, None, None]
        force = np.linalg.solve(
            np.eye(compliance.shape[-1]) + support * compliance,
            support * transfer(receptance, drive, contact)[:, 0, :, None],
        )[..., 0]
        free = transfer(receptance, drive, outputs)[:, 0]
        seen = transfer(receptance, outputs, contact)
        response[:, part] = (
            free - np.einsum("fop,fp->fo", seen, force)
        ).T * laplace ** TIME_DERIVATIVES[kind]
    return response
