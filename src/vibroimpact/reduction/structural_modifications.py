"""Changes of a structure or its modes: point masses, corrected frequencies, flexible plates, a base
that moves while the obstacles stay in space.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import sparse

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.structure.tube import TubeStructure

from .modal_model import MODE_FIELDS

# Amplitude of the base mode per metre of base motion. A contact force moves the base by the square
# of this times the motion of a mass of 1 kg.
BASE_SCALE = 1.0e-7


def with_point_masses(
    structure: Any, masses: Sequence[ConfigPart], point_rows: Callable[[str], np.ndarray]
) -> Any:
    """Return the structure with masses added at named points.

    masses: entries of the configuration.
    point_rows: function of a point's name that returns its displacement rows (3, dof).
    """
    if not masses:
        return structure
    rows = np.vstack([np.sqrt(mass.mass_kg) * point_rows(mass.point) for mass in masses])
    rows = sparse.csr_array(np.where(np.abs(rows) > 1.0e-15 * np.abs(rows).max(), rows, 0.0))
    changed = {"mass": (structure.mass + rows.T @ rows).tocsr()}
    if isinstance(structure, TubeStructure):  # others work it out from their mass
        carried = sum(mass.mass_kg * point_rows(mass.point) for mass in masses)
        changed["inertia"] = structure.inertia + carried
    return replace(structure, **changed)


def with_frequency_factors(
    omega: np.ndarray, factors: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return (omega (mode,) rad/s ascending, order (mode,)) with the first frequencies corrected.

    order is the number that each mode had before, because a corrected mode may pass its neighbours.

    omega: (mode,) rad/s as computed, ascending.
    factors: measured over computed frequency of the first modes.

    Raises ValueError when there are more factors than modes.
    """
    if len(factors) > len(omega):
        raise ValueError(f"mode_frequency_factors has {len(factors)} values for {len(omega)} modes")
    out = omega.copy()
    out[: len(factors)] *= factors
    order = np.argsort(out, kind="stable")
    return out[order], order


def with_support_plates(
    fields: dict[str, Any], supports: Sequence[ConfigPart], excitation: ConfigPart
) -> dict[str, Any]:
    """Return the fields of a ModalModel with two more modes per support on a flexible plate.

    They are the plate's motion along the contact directions. The contact sees the difference of
    tube and plate: the plate's shape there is -1/sqrt(mass), so that the contact force pushes it
    back. The inertia of a plate that rides on a moving base drives it.

    fields: {name: array} of a ModalModel, with the mode axis first.
    supports: entries of the configuration.
    excitation: section of the configuration.
    """
    rides = excitation.kind == "base_motion" and excitation.obstacles == "moving"
    carried = [number for number, support in enumerate(supports) if support.plate is not None]
    if not carried:
        return fields
    grown, mode = _with_modes(fields, 0, 2 * len(carried)), len(fields["omega"])
    for number, direction in itertools.product(carried, range(2)):
        plate, own_points = supports[number].plate, fields["support_of_point"] == number
        omega = np.sqrt(plate.stiffness_N_per_m / plate.mass_kg)
        shape = -1.0 / np.sqrt(plate.mass_kg)
        grown["omega"][mode] = omega
        grown["damping"][mode] = 2.0 * plate.damping_ratio * omega
        grown["contact_shapes"][mode, own_points, direction] = shape
        if rides:
            axes = fields["contact_directions"][own_points]
            along = axes[len(axes) // 2, direction] @ unit_vector(excitation.direction)
            grown["drive_shapes"][mode, 0] = -along / abs(shape)
        mode += 1
    order = np.argsort(grown["omega"], kind="stable")
    return grown | {name: grown[name][order] for name in MODE_FIELDS if name in grown}


def _with_modes(fields: dict[str, Any], before: int, behind: int) -> dict[str, Any]:
    """Return the fields of a ModalModel with modes that move nothing before and behind its own."""
    padded = {
        name: np.pad(fields[name], [(before, behind), *[(0, 0)] * (np.ndim(fields[name]) - 1)])
        for name in MODE_FIELDS
        if name in fields
    }
    return fields | padded


def with_base_mode(
    fields: dict[str, Any], excitation: ConfigPart, initial: ConfigPart | None
) -> dict[str, Any]:
    """Return the fields of a ModalModel with one more mode in front: the motion of the base.

    The obstacles stay in space. The mode has no stiffness, and only the case's acceleration drives
    it. Its share BASE_SCALE in the contact shapes turns relative displacements into absolute ones
    (the large mass method).

    fields: {name: array} of a ModalModel, with the mode axis first.
    excitation, initial: sections of the configuration.
    """
    direction = unit_vector(excitation.direction)
    moved = fields["contact_directions"] @ direction  # (contact_point, 2)
    grown = _with_modes(fields, 1, 0)
    grown["contact_shapes"][0] = BASE_SCALE * moved
    grown["drive_shapes"][0, 0] = 1.0 / BASE_SCALE
    if initial is not None:
        grown["initial_displacement"][0] = initial.base_displacement_m / BASE_SCALE
        grown["initial_velocity"][0] = initial.base_velocity_m_per_s / BASE_SCALE
    return grown
