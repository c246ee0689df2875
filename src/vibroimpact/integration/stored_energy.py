"""The energy stored in contacts and local elements, for the energy balance, in plain numpy."""

import numpy as np

from .entry_points import in_all_lanes
from .kernels.tables import Contact, Laws, State


def stored_energy(contact: Contact, laws: Laws, state: State) -> np.ndarray:
    """Energy in the springs of contacts, friction and local elements: (LANES,) J."""
    return _circles(contact, state) + _contact_laws(contact, laws, state) + _elements(laws, state)


def _circles(contact: Contact, state: State) -> np.ndarray:
    """Energy of the elastic circles, from their forces."""
    force = state.row_force[np.stack([contact.row_1, contact.row_2])]
    energy = 0.5 * contact.plain[:, None] * (force**2).sum(axis=0) / contact.stiffness
    return in_all_lanes(energy).sum(axis=0)


def _contact_laws(contact: Contact, laws: Laws, state: State) -> np.ndarray:
    """Energy of the special contact laws, from their penetration and friction force."""
    d = [
        state.row_displacement[row[laws.contact_point]] - offset[laws.contact_point]
        for row, offset in ((contact.row_1, contact.offset_1), (contact.row_2, contact.offset_2))
    ]
    lobes = laws.lobes[:, None]
    angle = np.arctan2(laws.lobe_sine, laws.lobe_cosine)
    wave = np.where(lobes > 0, 1.0 - np.cos(lobes * (np.arctan2(d[1], d[0]) - angle)), 0.0)
    round_depth = np.hypot(*d) - laws.gap - 0.5 * laws.lobe_depth * wave
    flat_depth = laws.normal_1 * d[0] + laws.normal_2 * d[1] - laws.gap
    depth = np.maximum(np.where(laws.flat[:, None] != 0, flat_depth, round_depth), 0.0)
    friction = 0.5 * laws.stick_flexibility * state.friction_force**2
    energy = 0.5 * laws.stiffness * depth**2 + 0.4 * laws.hertz * depth**2.5 + friction
    return in_all_lanes(energy).sum(axis=0)


def _elements(laws: Laws, state: State) -> np.ndarray:
    """Energy of the local elements, from their displacement and slider force."""
    u = state.row_displacement[laws.element_row]
    limit, stiffness = laws.saturation_limit, laws.saturation_stiffness
    yield_displacement = np.divide(
        limit, stiffness, out=np.zeros_like(limit), where=stiffness > 0.0
    )
    beyond = np.maximum(np.abs(u) - yield_displacement, 0.0)
    saturation = 0.5 * stiffness * (np.abs(u) - beyond) ** 2 + limit * beyond
    slider = 0.5 * laws.slider_flexibility * state.slider_force**2
    energy = (
        0.5 * laws.element_stiffness * u**2
        + laws.quadratic * u**3 / 3.0
        + laws.cubic * u**4 / 4.0
        + saturation
        + slider
    )
    return in_all_lanes(energy).sum(axis=0)
