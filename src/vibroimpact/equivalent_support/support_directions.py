"""The direction in which the force moves the contacts most, and the supports' shapes in it."""

from __future__ import annotations

import numpy as np

from vibroimpact.identify.linear.support_groups import acting_directions
from vibroimpact.reduction.modal_model import ModalModel


def driven_word(model: ModalModel) -> str:
    """Return the word for the contacts' direction that the force moves most."""
    index = driven_direction(model)
    words = list(acting_directions(model, int(np.argmax(model.contact_weight))))
    return words[min(index, len(words) - 1)]


def driven_direction(model: ModalModel) -> int:
    """Return 0 or 1: the direction of the contacts that the drive moves most, statically."""
    driven = np.abs(
        np.einsum(
            "mcd,m->cd",
            model.contact_shapes,
            model.drive_shapes[:, 0] / np.maximum(model.omega, 1.0) ** 2,
        )
    ).sum(axis=0)
    return int(np.argmax(driven))


def plate_shapes(model: ModalModel) -> np.ndarray:
    """Return (mode, support): mean displacement of each support's points along driven_direction."""
    along = model.contact_shapes[:, :, driven_direction(model)]
    return np.stack(
        [
            along[:, model.support_of_point == number]
            @ model.contact_weight[model.support_of_point == number]
            for number in range(len(model.support_names))
        ],
        axis=1,
    )
