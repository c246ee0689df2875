"""Scales of the parameters of effects, by which their bounds mean the same for any tube, load and
gap; computed by the linear stage from its model and signals.
"""

from collections.abc import Sequence

import numpy as np

from vibroimpact.effects.places import STOP
from vibroimpact.observation.signals import Signals
from vibroimpact.reduction.modal_model import ModalModel

SEARCHED = (0.03, 0.97)  # of a tube: its ends hardly move


def scales(
    model: ModalModel, signals: Signals, null: dict[str, float], tube_m: float | None
) -> dict[str, float]:
    """Return {name: value}: see effects.effect.Parameter. null: {"displacement", "speed"} RMS at
    the drive of the highest fit record, m and m/s; tube_m: length of the tube, None for another
    structure.
    """
    drive = model.drive_shapes[:, 0]
    elastic = model.omega > 0.0
    flexibility = np.sum(drive[elastic] ** 2 / model.omega[elastic] ** 2)
    driven = np.flatnonzero(np.abs(drive) > 0.3 * np.abs(drive).max())
    first = driven[0] if len(driven) else 0
    mass = 1.0 / max(drive[first] ** 2, 1.0e-300)
    stiffness = 1.0 / flexibility
    load = float(np.max(signals.load))
    gap = (
        float(np.nanmax(signals.gap))
        if np.isfinite(signals.gap).any()
        else float(null["displacement"])
    )
    contact = (
        np.bincount(model.support_of_point, model.contact_stiffness).max()
        if len(model.support_of_point)
        else stiffness
    )
    points = max(np.bincount(model.support_of_point).max(), 1) if len(model.support_of_point) else 1
    displacement, speed = max(null["displacement"], 1.0e-12), max(null["speed"], 1.0e-12)
    damping = model.damping[first] * mass
    # with the contacts: all sensors may be at one place
    known = np.vstack([model.sensor_positions, np.reshape(model.contact_position, (-1, 3))])
    length = max(float(np.ptp(known, axis=0).max()), 1.0e-3) * 3.0
    at_contact = model.contact_shapes.reshape(model.modes, -1)
    flexibility_at_contact = (
        np.sum(at_contact[elastic] ** 2 / model.omega[elastic][:, None] ** 2, axis=0).max()
        if at_contact.size
        else flexibility
    )
    return {
        "one": 1.0,
        "gap": gap,
        "load": load,
        "displacement": displacement,
        "contact_stiffness": contact,
        "hertz": contact / points / np.sqrt(0.03 * gap),
        "gap_force": gap / flexibility_at_contact,
        "mass": mass,
        "mass_per_length": mass / length,
        **searched(np.array(SEARCHED) * (np.nan if tube_m is None else tube_m)),
        "tube_translation": stiffness,
        "tube_rotation": stiffness * length**2 / 100.0,
        "tube_damping": damping,
        "damping_per_length": damping / length,
        "cubic": stiffness / displacement**2,
        "quadratic": stiffness / displacement,
        "slowness": 1.0 / speed,
        "drag": damping / length / speed,
    }


def searched(ends_m: Sequence[float] | np.ndarray) -> dict[str, float]:
    """Return the scales of a place that is searched between two arc lengths (2,) in m."""
    low, high = map(float, ends_m)
    return {"searched_from": low, "searched_length": high - low}


def clearance(model: ModalModel, gap: float, location: str) -> float | None:
    """Return the radial clearance in m of a model's supports at a location (a name, or all) at a
    nominal gap in m, None where they differ.
    """
    names = np.array(model.support_names)[model.support_of_point]
    there = names == location if location != "all" else names != STOP
    own = np.where(
        np.isnan(model.contact_laws.gap), model.gap_factor * gap, model.contact_laws.gap
    )[there]
    return float(own[0]) if own.size and np.allclose(own, own[0], rtol=1.0e-6) else None
