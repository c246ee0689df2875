"""The modes of a model without contact, with the linear part of its local elements included, and
the matching of modes of one model to those of another.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import optimize

from vibroimpact.contact.laws import LocalLaws
from vibroimpact.reduction.modal_model import ModalModel

MODE_ARRAYS = (
    "contact_shapes",
    "drive_shapes",
    "sensor_shapes",
    "line_shapes",
    "stress_shapes",
    "element_shapes",
)
# differences of ln frequency and of 1 - MAC that count the same
FREQUENCY_REACH, SHAPE_REACH = 0.2, 0.3


def linearised(model: ModalModel) -> ModalModel:
    """Return the ModalModel whose modes include the stiffness and damping of the local elements,
    and that has no local elements; of modal damping the diagonal is kept.
    """
    laws = model.local_laws
    if not len(laws.stiffness) or not (np.any(laws.stiffness) or np.any(laws.damping)):
        return model
    shapes = model.element_shapes
    squares, turn = np.linalg.eigh(np.diag(model.omega**2) + (shapes * laws.stiffness) @ shapes.T)
    damping = np.diag(turn.T @ (np.diag(model.damping) + (shapes * laws.damping) @ shapes.T) @ turn)
    fields: dict[str, Any] = {
        name: np.tensordot(turn.T, getattr(model, name), axes=1) for name in MODE_ARRAYS
    }
    fields["element_shapes"] = np.zeros((model.modes, 0))
    return replace(
        model,
        omega=np.sqrt(np.maximum(squares, 0.0)),
        damping=damping,
        element_names=(),
        local_laws=LocalLaws.neutral(0),
        **fields,
    )


def same_modes(
    model: ModalModel, modes: Iterable[int] | np.ndarray, reference: ModalModel
) -> np.ndarray:
    """Return (mode,) indices of the modes of `model` that correspond to `modes` of the reference:
    similar in shape at the sensors, near in frequency.
    """
    out: list[int] = []
    for mode in modes:
        wanted = reference.sensor_shapes[mode]
        alike = (model.sensor_shapes @ wanted) ** 2 / np.maximum(
            np.sum(model.sensor_shapes**2, axis=1) * (wanted @ wanted), 1.0e-300
        )
        distance = np.log(np.maximum(model.omega, 1.0e-3) / reference.omega[mode])
        score = alike / (1.0 + (distance / 0.15) ** 2)
        score[out] = -1.0
        out.append(int(np.argmax(score)))
    return np.array(out)


def matched(model: ModalModel, logs: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Return (mode,) indices of the modes of a ModalModel, each at most once, that are most similar
    to modes of ln rad/s logs (mode,) and shapes (channel, mode).
    """
    own = model.sensor_shapes
    alike = (own @ shapes) ** 2 / np.maximum(
        np.outer(np.sum(own**2, axis=1), np.sum(shapes**2, axis=0)), 1.0e-300
    )
    distance = np.log(np.maximum(model.omega, 1.0e-3))[:, None] - logs
    rows, columns = optimize.linear_sum_assignment(
        (distance / FREQUENCY_REACH) ** 2 + (1.0 - alike) / SHAPE_REACH
    )
    return rows[np.argsort(columns)]
