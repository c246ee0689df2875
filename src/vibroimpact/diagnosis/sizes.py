"""Sizes of a structure and its campaign: the bounds of the parameters of effects are multiples of
them, see effects.effect.SCALES.
"""

from __future__ import annotations

import numpy as np

from vibroimpact.effects.effect import Values
from vibroimpact.effects.places import length_m
from vibroimpact.reduction.modal_model import ModalModel

from .measurement.signals import Signals
from .measurement.stretches import Stretch

CONTACT_INDENTATION = 0.03  # of the gap: at it a Hertz contact is as stiff as the model's


def sizes_of(
    model: ModalModel, signals: Signals, highest: Stretch, rate: float, values: Values
) -> dict[str, float]:
    """Return {name: value in SI}.

    model: attached, its sensors scaled to displacements. highest: the stretch of the highest load;
    rate: its steps per second. values: configuration in plain values.
    """
    drive = model.drive_shapes[:, 0]
    elastic = model.omega > 0.0
    flexibility = _flexibility(model, drive[:, None], elastic)
    driven = np.flatnonzero(np.abs(drive) > 0.3 * np.abs(drive).max())
    first = driven[0] if len(driven) else 0
    mass, stiffness = 1.0 / max(drive[first] ** 2, 1.0e-300), 1.0 / flexibility
    displacement, speed = _motion_of_drive(model, highest, rate)
    gaps = signals.gap[np.isfinite(signals.gap)]
    gap = float(gaps.max()) if len(gaps) else displacement
    points = np.bincount(model.support_of_point) if len(model.support_of_point) else np.ones(1)
    contact = (
        float(np.bincount(model.support_of_point, model.contact_stiffness).max())
        if len(model.support_of_point)
        else stiffness
    )
    at_contact = model.contact_shapes.reshape(model.modes, -1)
    damping = float(model.damping[first] * mass)
    length = length_m(values) or _extent(model)
    return {
        "one": 1.0,
        "gap": gap,
        "load": float(np.max(signals.load)),
        "displacement": displacement,
        "contact_stiffness": contact,
        "hertz": contact / points.max() / np.sqrt(CONTACT_INDENTATION * gap),
        "gap_force": gap / _flexibility(model, at_contact, elastic, flexibility),
        "mass": mass,
        "mass_per_length": mass / length,
        "tube_translation": stiffness,
        "tube_rotation": stiffness * length**2 / 100.0,
        "tube_damping": damping,
        "damping_per_length": damping / length,
        "cubic": stiffness / displacement**2,
        "quadratic": stiffness / displacement,
        "slowness": 1.0 / speed,
        "drag": damping / length / speed,
        "tube_length": length,
    }


def _flexibility(model, shapes, elastic, otherwise=0.0):
    """Return the largest static flexibility in m/N of shapes (mode, place)."""
    if not shapes.size:
        return otherwise
    return float(np.max(np.sum(shapes[elastic] ** 2 / model.omega[elastic, None] ** 2, axis=0)))


def _motion_of_drive(model, highest, rate):
    """Return (m, m/s), the RMS displacement and speed at the first force, from the sensor that
    moves most.
    """
    moved = highest.motion.std(axis=0)
    sensor = int(np.argmax(moved))
    share = np.abs(model.drive_shapes[:, 0]).max() / np.abs(model.sensor_shapes[:, sensor]).max()
    speed = np.diff(highest.motion[:, sensor]).std() * rate
    return max(share * moved[sensor], 1.0e-12), max(share * speed, 1.0e-12)


def _extent(model):
    """Return three times the largest extent in m of the known places of a structure."""
    known = np.vstack([model.sensor_positions, np.reshape(model.contact_position, (-1, 3))])
    return max(float(np.ptp(known, axis=0).max()), 1.0e-3) * 3.0
