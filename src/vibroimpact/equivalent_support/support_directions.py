"""The word for the direction that the force moves the contacts in most: "y", "first", "normal"."""

from __future__ import annotations

import numpy as np

from vibroimpact.linear.support_groups import acting_directions
from vibroimpact.reduction.modal_model import ModalModel

from .scaled_law import driven_direction


def driven_word(model: ModalModel) -> str:
    """Return the word for the contacts' direction that the force moves most."""
    index = driven_direction(model)
    words = list(acting_directions(model, int(np.argmax(model.contact_weight))))
    return words[min(index, len(words) - 1)]
