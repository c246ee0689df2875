"""Frequency responses, PSDs and records of the linear tube on a support (k, c).

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
    frequency = np.atleast_1d(np.asarray(frequency, dtype=float))
    response = np.empty((output_shapes.shape[1], len(frequency)), dtype=complex)
    for first in range(0, len(frequency), FREQUENCY_CHUNK):
        part = slice(first, first + FREQUENCY_CHUNK)
        laplace = 2j * np.pi * frequency[part]
        free, compliance, reached, seen = _contact_receptances(
            model, laplace, output_shapes, channel
        )
        support = (k + laplace * c)[:, None, None]
        force = np.linalg.solve(
            np.eye(compliance.shape[-1]) + support * compliance, support * reached[..., None]
        )[..., 0]
        response[:, part] = (
            free - np.einsum("fop,fp->fo", seen, force)
        ).T * laplace ** TIME_DERIVATIVES[kind]
    return response


def response_psd(
    model: ModalModel,
    k: float,
    c: float,
    frequency: np.ndarray | Sequence[float] | float,
    output_shapes: np.ndarray,
    kind: str = "displacement",
) -> np.ndarray:
    """Return (output, frequency) PSD of the response per PSD of the load, all channels together.

    The forces of several channels, as turbulence has them, are independent and have the same PSD:
    the sum over channels of the squared magnitude of frf. Unit and arguments as of frf, squared.
    """
    total = np.zeros((output_shapes.shape[1], np.size(frequency)))
    for channel in range(model.drive_shapes.shape[1]):
        response = frf(model, k, c, frequency, output_shapes, kind, channel)
        total += response.real**2 + response.imag**2
    return total


def psd_family(
    model: ModalModel,
    k_grid: np.ndarray,
    c_grid: np.ndarray,
    frequency: np.ndarray,
    shape: np.ndarray,
) -> np.ndarray:
    """Return (k, c, frequency) (m/N)²: PSD of the displacement per unit PSD of the force.

    The forces of several channels are independent and have the same PSD. With G = V diag(l) V^-1 at
    one frequency, the response is h_free - sum_j (a V)_j (V^-1 b)_j s / (1 + s l_j). One eigenvalue
    problem per frequency serves all (k, c).

    k_grid: (k,) N/m.
    c_grid: (c,) N s/m.
    frequency: (frequency,) Hz.
    shape: (mode,) of the output.
    """
    channels = range(model.drive_shapes.shape[1])
    grids = (k_grid, c_grid, np.asarray(frequency, dtype=float))
    total = _channel_psds(model, *grids, shape, 0)
    for channel in channels[1:]:
        total = total + _channel_psds(model, *grids, shape, channel)
    return total


def _channel_psds(
    model: ModalModel,
    k_grid: np.ndarray,
    c_grid: np.ndarray,
    frequency: np.ndarray,
    shape: np.ndarray,
    channel: int,
) -> np.ndarray:
    """Return (k, c, frequency) (m/N)², psd_family of displacements by one force channel."""
    laplace = 2j * np.pi * frequency
    free, compliance, reached, seen = _contact_receptances(
        model, laplace, np.asarray(shape)[:, None], channel
    )
    flexibility, vectors = np.linalg.eig(compliance)
    share = np.linalg.solve(vectors, reached[..., None])[..., 0] * np.einsum(
        "fp,fpj->fj", seen[:, 0], vectors
    )
    support = (
        np.asarray(k_grid, dtype=float)[:, None, None]
        + np.asarray(c_grid, dtype=float)[None, :, None] * laplace
    )
    response = np.broadcast_to(free[:, 0], support.shape).copy()
    for term in range(flexibility.shape[1]):
        response -= share[:, term] * support / (1.0 + support * flexibility[:, term])
    return response.real**2 + response.imag**2


def _contact_receptances(
    model: ModalModel, laplace: np.ndarray, output_shapes: np.ndarray, channel: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (free, compliance, reached, seen): the tube without support at its contacts.

    free: (frequency, output) m/N, response to the drive.
    compliance: (frequency, contact_row, contact_row) m/N.
    reached: (frequency, contact_row) m/N, contact displacement per unit drive.
    seen: (frequency, output, contact_row) m/N, output per unit contact force.

    Only blocks and contact rows that the drive moves appear.

    laplace: (frequency,) i omega in rad/s.
    """
    driven = [
        modes for modes, _ in model.blocks if np.any(model.drive_shapes[modes, channel] != 0.0)
    ]
    modes = np.sort(np.concatenate(driven)) if driven else np.zeros(0, dtype=int)
    contact = contact_matrix(model)[modes]
    contact = contact[:, (contact != 0.0).any(axis=0)]
    drive, outputs = model.drive_shapes[modes, channel][:, None], output_shapes[modes]
    receptance = 1.0 / (
        laplace[:, None] ** 2 + laplace[:, None] * model.damping[modes] + model.omega[modes] ** 2
    )
    return (
        transfer(receptance, drive, outputs)[:, 0],
        transfer(receptance, contact, contact),
        transfer(receptance, drive, contact)[:, 0],
        transfer(receptance, outputs, contact),
    )
