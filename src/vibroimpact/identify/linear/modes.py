"""Undamped modes of the linear tube on its equivalent support.

The equivalent support is bilateral: stiffness k [N/m] and damping c [N s/m] per support. It acts in
both transverse directions of every support and is shared by the contact points with their weights.
On the modes, with W = B B^T and B the contact shapes times the square root of the weights,

    stiffness = diag(omega²) + k W,    damping = diag(damping) + c W.

k = c = 0 is the tube without contact.
"""

import numpy as np
from scipy import linalg

from vibroimpact.reduction.modal_model import ModalModel


class PoleError(ValueError):
    """A mode or pole that does not exist, was not found, or could not be followed."""


def contact_matrix(model: ModalModel) -> np.ndarray:
    """Return B (mode, contact_row) in kg^-1/2: contact shapes times the root of their weights.

    There is one row per contact point and direction, and W = B B^T.
    """
    scaled = model.contact_shapes * np.sqrt(model.contact_weight)[None, :, None]
    return scaled.reshape(model.modes, -1)


def transfer(receptance: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return (frequency, left, right) the motion along shapes per unit force along others, m/N.

    receptance: (frequency, mode) s². left, right: (mode, left) and (mode, right) kg^-1/2.
    """
    pairs = left[:, :, None] * right[:, None, :]
    moved = receptance @ pairs.reshape(len(pairs), pairs.shape[1] * pairs.shape[2])
    return moved.reshape(len(receptance), *pairs.shape[1:])


def driven_block(model: ModalModel) -> np.ndarray:
    """Return (mode,) indices of the uncoupled block that the force channels move most.

    The measure is its static displacement under unit forces. For a tube driven across its plane
    these are the out-of-plane modes. Raises ValueError when no force moves a contact.
    """
    blocks = [modes for modes, contacts in model.blocks if contacts]
    static = [
        np.sum((model.drive_shapes[modes] / np.maximum(model.omega[modes, None], 1.0)) ** 2)
        for modes in blocks
    ]
    if not blocks or max(static) == 0.0:
        raise ValueError(
            "the force moves no contact point: no support stiffness can be seen from it"
        )
    return blocks[int(np.argmax(static))]


def natural_frequencies(model: ModalModel, k: float, count: int) -> np.ndarray:
    """Return the `count` lowest undamped frequencies in Hz with support stiffness k in N/m.

    There are fewer when the model has fewer modes.
    """
    contact = contact_matrix(model)
    squares = []
    for modes, _ in model.blocks:
        squares.append(np.linalg.eigvalsh(support_stiffness(model.omega[modes], contact[modes], k)))
    lowest = np.sort(np.concatenate(squares))[:count]
    return np.sqrt(np.maximum(lowest, 0.0)) / (2.0 * np.pi)


def first_mode_shape(model: ModalModel, k: float) -> np.ndarray:
    """Return (line_point,) the first mode of the driven block with support stiffness k in N/m.

    It has unit modal mass (kg^-1/2), and its largest component is positive.
    """
    modes = driven_block(model)
    _, vector = first_mode(model, modes, k)
    shape = model.line_shapes[modes].T @ vector
    return shape if shape[np.argmax(np.abs(shape))] > 0.0 else -shape


def first_mode(model: ModalModel, modes: np.ndarray, k: float) -> tuple[float, np.ndarray]:
    """Return (omega in rad/s, vector (mode,)) of the lowest mode in a block.

    modes: (mode,) indices of the block.
    k: support stiffness in N/m.

    Raises PoleError when there is no vibration: a free tube without support, or a negative k under
    which the tube buckles.
    """
    square, vector = linalg.eigh(
        support_stiffness(model.omega[modes], contact_matrix(model)[modes], k),
        subset_by_index=[0, 0],
    )
    if square[0] <= 0.0:
        raise PoleError(
            f"with a support stiffness of {k:.6g} N/m the tube has no lowest frequency above 0"
        )
    return np.sqrt(square[0]), vector[:, 0]


def support_stiffness(omega: np.ndarray, contact: np.ndarray, k: float) -> np.ndarray:
    """Return (mode, mode) diag(omega²) + k B B^T."""
    return np.diag(omega**2) + k * contact @ contact.T
