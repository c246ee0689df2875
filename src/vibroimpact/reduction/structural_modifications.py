"""Changes of a structure or its modes: point masses, corrected frequencies, flexible plates."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import sparse

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.excitation.force_vectors import MODE_FIELDS
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.structure.tube import TubeStructure


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
    grown = dict(fields)
    for number, support in enumerate(supports):
        if support.plate is None:
            continue
        omega = np.sqrt(support.plate.stiffness_N_per_m / support.plate.mass_kg)
        for direction in range(2):
            for name in MODE_FIELDS:
                grown[name] = np.concatenate([grown[name], np.zeros((1, *grown[name].shape[1:]))])
            grown["omega"][-1] = omega
            grown["damping"][-1] = 2.0 * support.plate.damping_ratio * omega
            own_points = fields["support_of_point"] == number
            shape = -1.0 / np.sqrt(support.plate.mass_kg)
            grown["contact_shapes"][-1, own_points, direction] = shape
            if rides:
                axes = fields["contact_directions"][own_points]
                along = axes[len(axes) // 2, direction] @ unit_vector(excitation.direction)
                grown["drive_shapes"][-1, 0] = -along / abs(shape)
    if len(grown["omega"]) == len(fields["omega"]):
        return fields
    order = np.argsort(grown["omega"], kind="stable")
    return grown | {name: grown[name][order] for name in MODE_FIELDS}
