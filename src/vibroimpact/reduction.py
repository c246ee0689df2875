"""The reduced model of a configuration: structure -> Ritz basis -> ModalModel."""

import numpy as np
from scipy import linalg

from vibroimpact.centreline import SAME_PLACE_M, unit_vector
from vibroimpact.model import ModalModel
from vibroimpact.ritz import FAMILIES, basis_vectors, eigenmodes, orthonormal_basis, uncoupled_groups
from vibroimpact.structure import build_structure

AXES = dict(zip("xyz", np.eye(3), strict=True))
REPORT_STIFFNESS = (*(10.0**power for power in range(7)), 4.0e6, 1.0e7, 1.0e8, 1.0e9)  # N/m per support
REPORT_TO_HZ = 400.0
# Name of a basis -> (families, fraction of the free modes' cut-off that is kept).
REPORT_BASES = {
    "all": (FAMILIES, 1.0),
    **{f"{family} alone": ((family,), 1.0) for family in FAMILIES},
    **{f"without {family}": (tuple(other for other in FAMILIES if other != family), 1.0) for family in FAMILIES},
    "free_modes to a tenth": (FAMILIES, 0.1),
    **{f"free_modes to a tenth, without {family}": (tuple(other for other in FAMILIES if other != family), 0.1)
       for family in FAMILIES[1:]},
}


def build_model(config):
    """Return the ModalModel of a configuration (parts structure, supports, damping, points, excitation, basis, record).

    Raises ValueError when a support or a named point is off the tube (farther than 5 mm), or a name is unknown.
    """
    structure = build_structure(config)
    contact = structure.contact
    groups = uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows())
    omega, shapes = modal_basis(structure, groups, config.basis)
    free = [eigenmodes(group.stiffness, group.mass, config.basis.free_modes_to_Hz)[0] for group in groups]
    return ModalModel(
        omega=omega,
        damping=modal_damping(omega, config.damping),
        contact_shapes=np.einsum("cdn,nm->mcd", structure.contact_rows(), shapes),
        contact_directions=contact.directions,
        contact_weight=contact.weight,
        support_of_point=contact.support,
        support_names=tuple(support.name for support in config.supports),
        contact_stiffness=contact.stiffness,
        gap_factor=contact.gap_factor,
        centre_offset=contact.centre_offset,
        contact_position=contact.position,
        full_mode_frequencies=np.sort(np.concatenate(free)) / (2.0 * np.pi),
        **_drive_fields(structure, shapes, config),
        **_sensor_fields(structure, shapes, config),
        **_line_fields(structure, shapes, config),
        **_stress_fields(structure, shapes, config),
    )


def modal_basis(structure, groups, basis, families=FAMILIES):
    """Return (omega (mode,) rad/s ascending, shapes (dof, mode)) of the Ritz basis, each uncoupled group treated by itself.

    A shape is exactly 0.0 outside its group. Frequencies above basis.free_modes_to_Hz belong to what constrained modes and attachment
    shapes add to the free modes: they are residual vectors, not modes of the tube, and carry the local flexibility at the contacts.
    """
    omegas, columns = [], []
    for group in groups:
        omega, inside = orthonormal_basis(group, basis_vectors(group, basis, families))
        shapes = np.zeros((structure.dofs, len(omega)))
        shapes[group.dofs] = inside
        omegas.append(omega)
        columns.append(shapes)
    omega, shapes = np.concatenate(omegas), np.hstack(columns)
    order = np.argsort(omega, kind="stable")
    return omega[order], shapes[:, order]


def modal_damping(omega, damping):
    """Return (mode,) 2 zeta omega in 1/s for ascending omega (mode,) rad/s.

    damping.kind modal: first_ratios for the first modes that are not rigid-body motion, other_ratio for the rest. rayleigh:
    C = mass_coefficient M + stiffness_coefficient K, diagonal in this basis.
    """
    if damping.kind == "rayleigh":
        return damping.mass_coefficient_per_s + damping.stiffness_coefficient_s * omega**2
    ratios = np.full(len(omega), float(damping.other_ratio))
    elastic = np.flatnonzero(omega > 0.0)[:len(damping.first_ratios)]
    ratios[elastic] = damping.first_ratios[:len(elastic)]
    return 2.0 * ratios * omega


def quality_report(config):
    """Return a list of rows (dict) that compare reduced with full frequencies, with bilateral contact from k = 1 to 1e9 N/m.

    Row keys: vectors ("all", "free_modes alone", ... see REPORT_BASES: what the basis is made of), modes (their number in the group),
    stiffness_N_per_m (per support), group (uncoupled group of dofs), mode (from 1, in its group), full_Hz, reduced_Hz (NaN where the
    basis has fewer modes), relative_error. Modes of the full model up to 400 Hz. A Ritz basis can only stiffen: relative_error is
    positive, but for the round-off of the full eigenvalues (about 1e-8).
    """
    structure = build_structure(config)
    groups = uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows())
    share = np.sqrt(np.repeat(structure.contact.weight, 2))
    rows = []
    for number, group in enumerate(groups):
        contact = share[group.contact_rows][:, None] * group.contact
        bases = _report_bases(group, config.basis)
        for stiffness in REPORT_STIFFNESS:
            full = eigenmodes(group.stiffness + stiffness * contact.T @ contact, group.mass, REPORT_TO_HZ)[0] / (2.0 * np.pi)
            for name, basis in bases.items():
                reduced = _reduced_frequencies(basis, contact, stiffness, len(full))
                rows += [{"vectors": name, "modes": len(basis[0]), "stiffness_N_per_m": stiffness, "group": number, "mode": mode + 1,
                          "full_Hz": full[mode], "reduced_Hz": reduced[mode], "relative_error": reduced[mode] / full[mode] - 1.0}
                         for mode in range(len(full))]
    return rows


def _report_bases(group, basis):
    """Return {name: (omega, shapes)}: the orthonormal bases of REPORT_BASES for one group."""
    vectors = basis_vectors(group, basis)
    free_Hz = eigenmodes(group.stiffness, group.mass, basis.free_modes_to_Hz)[0] / (2.0 * np.pi)
    bases = {}
    for name, (families, fraction) in REPORT_BASES.items():
        chosen = {family: vectors[family] for family in families if family in vectors}
        if "free_modes" in chosen:
            chosen["free_modes"] = chosen["free_modes"][:, free_Hz <= fraction * basis.free_modes_to_Hz]
        bases[name] = orthonormal_basis(group, chosen)
    return bases


def _reduced_frequencies(basis, contact, stiffness, count):
    """Return (count,) Hz, NaN beyond the modes there are, of a basis (omega, shapes) on springs `stiffness` at `contact` rows."""
    omega, shapes = basis
    moved = contact @ shapes
    squares = linalg.eigvalsh(np.diag(omega**2) + stiffness * moved.T @ moved) if len(omega) else np.zeros(0)
    frequencies = np.full(count, np.nan)
    frequencies[:len(squares)] = np.sqrt(np.maximum(squares[:count], 0.0)) / (2.0 * np.pi)
    return frequencies


def named_arc_length(structure, config, name):
    """Return the arc length in m of a named point; raises ValueError for an unknown name or a point off the tube."""
    if name not in config.points:
        raise ValueError(f"point '{name}' is not among points: {', '.join(sorted(config.points))}")
    return structure.centreline.locate(config.points[name], f"point {name}")


def _drive_fields(structure, shapes, config):
    """Return the field drive_shapes (mode, force_channel): displacement along the force at its point."""
    row = structure.displacement_rows(named_arc_length(structure, config, config.excitation.point))
    return {"drive_shapes": (unit_vector(config.excitation.direction) @ row @ shapes)[:, None]}


def _sensor_fields(structure, shapes, config):
    """Return the fields of the sensors: every point of record.sensors in every direction, named "point.direction"."""
    names, positions, directions, rows = [], [], [], []
    for name in config.record.sensors.points:
        place = named_arc_length(structure, config, name)
        for axis in config.record.sensors.directions:
            names.append(f"{name}.{axis}")
            positions.append(structure.centreline.position(place))
            directions.append(AXES[axis])
            rows.append(AXES[axis] @ structure.displacement_rows(place))
    return {"sensor_names": tuple(names), "sensor_positions": np.array(positions), "sensor_directions": np.array(directions),
            "sensor_shapes": (np.array(rows) @ shapes).T}


def _line_fields(structure, shapes, config):
    """Return the fields of the shape line: points evenly spaced in arc length from end to end, the ends left out."""
    line = config.record.shape_line
    places = structure.centreline.length * np.arange(1, line.points + 1) / (line.points + 1)
    rows = np.array([AXES[line.direction] @ structure.displacement_rows(place) for place in places])
    return {"line_shapes": (rows @ shapes).T, "line_arc_length": places,
            "line_positions": np.array([structure.centreline.position(place) for place in places])}


def _stress_fields(structure, shapes, config):
    """Return stress_shapes and section_names: both ends, edges and middle of each support, drive and sensor points.

    Sections at the same place appear once, under the first name.
    """
    places = {"root_start": 0.0, "root_end": structure.centreline.length}
    for number, support in enumerate(config.supports):
        points = structure.contact.arc_length[structure.contact.support == number]
        for part, place in (("start", points[0]), ("middle", 0.5 * (points[0] + points[-1])), ("end", points[-1])):
            places[f"{support.name}_{part}"] = place
    for name in (config.excitation.point, *config.record.sensors.points):
        places[name] = named_arc_length(structure, config, name)
    names, kept = [], []
    for name, place in places.items():
        if all(abs(place - other) > SAME_PLACE_M for other in kept):
            names.append(name)
            kept.append(place)
    rows = np.array([structure.stress_rows(place) for place in kept])
    return {"section_names": tuple(names), "stress_shapes": np.einsum("sdn,nm->msd", rows, shapes)}
