"""What changes a structure or its modes beyond elements and supports: point masses, corrected
frequencies, plates that give way.
"""

from dataclasses import replace

import numpy as np
from scipy import sparse

from vibroimpact.excitation.force_vectors import MODE_FIELDS


def with_masses(structure, masses, place):
    """Return the structure with `masses` (config entries) added at their points; place: function
    name -> (3, dof) displacement rows.
    """
    if not masses:
        return structure
    rows = np.vstack([np.sqrt(mass.mass_kg) * place(mass.point) for mass in masses])
    rows = sparse.csr_array(np.where(np.abs(rows) > 1.0e-15 * np.abs(rows).max(), rows, 0.0))
    return replace(structure, mass=(structure.mass + rows.T @ rows).tocsr())


def with_factors(omega, factors):
    """Return (omega (mode,) rad/s ascending, order (mode,)): free modes measured at other
    frequencies than computed.

    factors: measured over computed frequency of the first modes as they were computed; order: the
    number that each mode had then, for a mode may pass its neighbours. Raises ValueError when there
    are more factors than modes.
    """
    if len(factors) > len(omega):
        raise ValueError(f"mode_frequency_factors has {len(factors)} values for {len(omega)} modes")
    out = omega.copy()
    out[: len(factors)] *= factors
    order = np.argsort(out, kind="stable")
    return out[order], order


def with_plates(fields, supports):
    """Return the fields of a ModalModel with two modes more per support that a plate carries: its
    motion along the contact directions.

    The contact sees the difference of tube and plate: the plate's shape there is -1/sqrt(mass), and
    the contact force pushes it back. fields: {name: array} with the mode axis first, as ModalModel
    has them.
    """
    grown = dict(fields)
    for number, support in enumerate(supports):
        if support.plate is None:
            continue
        omega = np.sqrt(support.plate.stiffness_N_per_m / support.plate.mass_kg)
        for direction in range(2):
            for name in MODE_FIELDS:
                grown[name] = np.concatenate([grown[name], np.zeros((1, *grown[name].shape[1:]))])
            grown["omega"][-1], grown["damping"][-1] = (
                omega,
                2.0 * support.plate.damping_ratio * omega,
            )
            grown["contact_shapes"][-1, fields["support_of_point"] == number, direction] = (
                -1.0 / np.sqrt(support.plate.mass_kg)
            )
    order = np.argsort(grown["omega"], kind="stable")
    return (
        grown | {name: grown[name][order] for name in MODE_FIELDS}
        if len(order) > len(fields["omega"])
        else fields
    )
