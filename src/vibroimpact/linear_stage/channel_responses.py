"""Responses of modes in the channels of a record, at its Fourier lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vibroimpact.observation.linear_record import LinearRecord
from vibroimpact.observation.sensed_motion import kind_groups


def responses_of(
    record: LinearRecord,
    omega: np.ndarray,
    damping: np.ndarray,
    drive_shapes: np.ndarray,
    kinds: Sequence[str] | np.ndarray,
) -> dict[str, np.ndarray]:
    """Return {kind: (mode, line)}: LinearRecord.responses of each kind of motion in kinds."""
    return {
        kind: record.responses(omega, damping, drive_shapes, kind) for kind in kind_groups(kinds)
    }


def combined(
    shapes: np.ndarray, basis: dict[str, np.ndarray], kinds: Sequence[str] | np.ndarray
) -> np.ndarray:
    """Return (channel, line): the response of channels with participations shapes (channel, mode)
    to modal responses {kind: (mode, line)}, each of its own kind (channel,).
    """
    lines = next(iter(basis.values()))
    out = np.empty((len(shapes), lines.shape[1]), complex)
    for kind, own in kind_groups(kinds).items():
        out[own] = shapes[own] @ basis[kind]
    return out


def without_base(lines: np.ndarray, record: LinearRecord, weights: np.ndarray) -> np.ndarray:
    """Return lines (channel, line) minus the multiple of the motion of the base in each channel
    that fits them best by weights (channel, line).
    """
    if record.base is None:
        return lines
    base = weights**2 * record.base
    size = np.sum(np.abs(weights * record.base) ** 2, axis=-1)
    share = np.sum((base.conj() * lines).real, axis=-1) / np.where(size > 0.0, size, 1.0)
    return lines - share[:, None] * record.base
