"""Which of the two transverse directions of a contact point a word such as "y" means."""

from __future__ import annotations

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .answer import EquivalentError
from .scaled_law import driven_direction

AXES = "xyz"
WORDS = {"first": 0, "second": 1, "0": 0, "1": 1}


def driven_axis_of(model: ModalModel) -> str:
    """Return "x", "y" or "z": the global axis nearest to the contacts' driven direction."""
    along = np.abs(model.contact_directions[:, driven_direction(model)]).sum(axis=0)
    return AXES[int(np.argmax(along))]


def direction_index(model: ModalModel, point: int, word: str) -> int:
    """Return 0 or 1: the contact direction of a point that a word names.

    word: "x", "y" or "z" for the direction nearest to that axis, or "first" or "second".

    Raises EquivalentError for another word, and where the point moves along neither direction.
    """
    if word in WORDS:
        return WORDS[word]
    if word not in AXES or len(word) != 1:
        raise EquivalentError(
            f"direction '{word}' is none of x, y, z, first and second: it can not be placed on the"
            " structure"
        )
    along = np.abs(model.contact_directions[point, :, AXES.index(word)])
    if along.max() < 0.5:
        name = model.support_names[model.support_of_point[point]]
        raise EquivalentError(
            f"direction '{word}' is along the tube at support {name}: its transverse directions"
            " are others"
        )
    return int(np.argmax(along))
