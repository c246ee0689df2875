"""The directions that a contact point acts in, and the words for them: "y", "first", "normal"."""

from __future__ import annotations

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .scaled_law import driven_direction

ALIGNED = 0.999  # least cosine of the angle to a global axis that gives a direction its name
PARALLEL = 1.0e-9  # largest sine of the angle between the normals of parallel stops
AXES = "xyz"


def acting_directions(model: ModalModel, point: int) -> dict[str, np.ndarray]:
    """Return {word: unit vector (3,)} of the directions that a contact point acts in.

    They are its two transverse directions, or the normal alone of parallel stops. A direction has
    the name of the global axis that it lies along, "normal" for oblique parallel stops, else
    "first" or "second".
    """
    axes = model.contact_directions[point]
    laws = model.contact_laws
    normals = laws.land_normal[laws.land_point == point]
    if len(normals):
        first = normals[0]
        across = normals @ np.array([-first[1], first[0]])
        if np.all(np.abs(across) < PARALLEL):
            vector = first @ axes
            return {_word(vector, "normal"): vector}
    return {
        _word(vector, other): vector
        for vector, other in zip(axes, ("first", "second"), strict=True)
    }


def driven_word(model: ModalModel) -> str:
    """Return the word for the contacts' direction that the force moves most."""
    index = driven_direction(model)
    words = list(acting_directions(model, int(np.argmax(model.contact_weight))))
    return words[min(index, len(words) - 1)]


def _word(vector: np.ndarray, other: str) -> str:
    """Return the global axis that a unit vector lies along, else another word."""
    axis = int(np.argmax(np.abs(vector)))
    return AXES[axis] if abs(vector[axis]) > ALIGNED else other
