"""Resonances of a record found without the frequencies of the model, one after the other, each
where it explains most of the residual: part of the identification of modes.

Orthogonal matching pursuit (Y.C. Pati, R. Rezaiifar, P.S. Krishnaprasad, Asilomar Conf., 1993) over
single-mode responses to the measured force. The modes found are then assigned to those of the model
by shape and frequency.
"""

from collections.abc import Sequence

import numpy as np
from scipy import linalg, optimize

from vibroimpact.observation.linear_record import LinearRecord
from vibroimpact.observation.sensed_motion import kind_groups
from vibroimpact.reduction.modal_model import ModalModel

from .channel_responses import combined

SPACING = 2.0e-3  # of ln frequency between the resonances that are tried
BESIDE = 6  # of these steps: nearer resonances are the same mode
AT_ONCE = 32  # resonances whose responses are computed at a time
FAR = 0.3  # of ln frequency: as bad a match as an orthogonal shape


def pursued(
    record: LinearRecord,
    measured: np.ndarray,
    weights: np.ndarray,
    count: int,
    zeta: float,
    kinds: Sequence[str] | np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return (ln rad/s (count,), shapes (channel, count)) of the resonances of measured (channel,
    line), weighted by weights of the same shape.

    count: how many; zeta: damping ratio of the resonances that are tried; kinds (channel,): of
    motion.
    """
    logs = np.arange(
        np.log(2.0 * np.pi * record.frequency[0]),
        np.log(2.0 * np.pi * record.frequency[-1]),
        SPACING,
    )
    omega = np.exp(logs)
    drive = np.eye(1, record.spectrum.shape[0])
    # the largest arrays of the linear stage: in single precision, and computed in parts, so that no
    # array of double precision is as large
    basis, channels = {}, kind_groups(kinds)
    for kind in channels:
        basis[kind] = np.concatenate(
            [
                record.responses(part, 2.0 * zeta * part, drive, kind).astype(np.complex64)
                for part in np.array_split(omega, len(omega) // AT_ONCE + 1)
            ]
        )

    def against(values, lines):
        """Return (channel, tried): values (channel, line) times the lines of each channel's
        basis.
        """
        out = np.empty((len(values), len(omega)), values.dtype)
        for kind, own in channels.items():
            out[own] = (lines(basis[kind]) @ values[own].T).T
        return out

    power = against((weights**2).astype(np.float32), lambda lines: np.abs(lines) ** 2).astype(float)
    open_, chosen, rest = np.ones(len(omega), bool), [], measured
    shapes = np.zeros((len(measured), 0))
    for _ in range(count):
        weighted = (weights**2 * rest).conj().astype(np.complex64)
        alike = np.real(against(weighted, lambda lines: lines)).astype(float)
        gain = np.sum(alike**2 / power, axis=0)
        best = int(np.argmax(np.where(open_, gain, -1.0)))
        chosen.append(best)
        open_[max(0, best - BESIDE) : best + BESIDE + 1] = False
        taken = {kind: lines[chosen] for kind, lines in basis.items()}
        shapes = np.array(
            [
                linalg.lstsq(_real(row * taken[kind]).T, _real(row * values))[0]
                for row, values, kind in zip(weights, measured, kinds, strict=True)
            ]
        )
        rest = measured - combined(shapes, taken, kinds)
    return logs[chosen], shapes


def assigned(
    logs: np.ndarray, shapes: np.ndarray, model: ModalModel, modes: np.ndarray
) -> np.ndarray:
    """Return (mode,) ln of the found over the model's frequency of modes (mode,) of a ModalModel;
    logs, shapes: as pursued returns them, in any order.
    """
    own = model.sensor_shapes[modes]
    match = (own @ shapes) ** 2 / np.maximum(
        np.outer(np.sum(own**2, axis=1), np.sum(shapes**2, axis=0)), 1.0e-300
    )
    distance = logs - np.log(model.omega[modes])[:, None]
    _, found = optimize.linear_sum_assignment(1.0 - match + np.abs(distance) / FAR)
    return distance[np.arange(len(modes)), found]


def _real(values):
    return np.concatenate([values.real, values.imag], axis=-1)
