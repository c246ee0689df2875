"""The smallest model: one mass that moves in a plane, with a contact or a local element."""

from dataclasses import replace

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.structure.contact.laws import ContactLaws, LocalLaws


def oscillator(
    mass,
    stiffness,
    damping=0.0,
    contact_stiffness=None,
    lands=(),
    contact=None,
    element=None,
    displacement=(0.0, 0.0),
    velocity=(0.0, 0.0),
    dead_load=(0.0, 0.0),
):
    """Return the ModalModel of a mass (kg) on springs (N/m) and dampers (N s/m) alike in both
    directions.

    contact: columns of ContactLaws for its one contact point (contact_stiffness N/m), flat with
    `lands`; element: columns of LocalLaws for an element along the first direction; displacement m,
    velocity m/s, dead_load N: initial state and constant force.
    """
    points = int(contact_stiffness is not None or contact is not None)
    elements = int(element is not None)
    shape = np.eye(2) / np.sqrt(mass)
    laws = ContactLaws.neutral(points)
    if points:
        laws = laws.with_columns(
            **{name: float(value) for name, value in (contact or {}).items() if name != "gap"}
        )
        laws = laws.with_columns(gap=(contact or {}).get("gap", np.nan))
    if lands:
        laws = laws.with_columns(land_point=np.zeros(len(lands), int), land_normal=np.array(lands))
    local = replace(
        LocalLaws.neutral(elements),
        **{name: np.array([value]) for name, value in (element or {}).items()},
    )
    return ModalModel(
        omega=np.full(2, np.sqrt(stiffness / mass)),
        damping=np.full(2, damping / mass),
        contact_shapes=np.tile(shape[:, None, :], (1, points, 1)),
        contact_directions=np.tile(np.eye(3)[:2], (points, 1, 1)),
        contact_weight=np.ones(points),
        support_of_point=np.zeros(points, int),
        support_names=("stop",) * points,
        contact_stiffness=np.full(points, contact_stiffness or 0.0),
        gap_factor=np.ones(points),
        drive_shapes=shape[:, :1],
        sensor_shapes=shape,
        sensor_names=("mass.x", "mass.y"),
        sensor_positions=np.zeros((2, 3)),
        sensor_directions=np.eye(3)[:2],
        full_mode_frequencies=np.array([1.0]),
        contact_laws=laws,
        element_shapes=np.tile(shape[:, :1], (1, elements)),
        element_names=("element",) * elements,
        local_laws=local,
        initial_displacement=np.sqrt(mass) * np.array(displacement),
        initial_velocity=np.sqrt(mass) * np.array(velocity),
        constant_force=np.array(dead_load) / np.sqrt(mass),
    )
