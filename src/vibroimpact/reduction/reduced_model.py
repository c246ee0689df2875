"""The reduced model of a configuration: structure -> Ritz basis -> ModalModel."""

import numpy as np
from scipy import linalg, sparse

from vibroimpact.config.name_checks import TUBES
from vibroimpact.contact.local_elements import element_laws, element_rows, split_damping
from vibroimpact.contact.supports import contact_laws
from vibroimpact.excitation.force_vectors import dead_load, force_row, turn_axis, with_base_mode
from vibroimpact.geometry.centreline import SAME_PLACE_M
from vibroimpact.memo import Kept, content_key
from vibroimpact.structure.point_structure import PointStructure, build_point_structure
from vibroimpact.structure.tube import build_structure

from .modal_model import ModalModel
from .ritz_basis import FAMILIES, basis_vectors, eigenmodes, orthonormal_basis, uncoupled_groups
from .structural_modifications import with_factors, with_masses, with_plates

BASES = Kept()
AXES = dict(zip("xyz", np.eye(3), strict=True))
SMALL = 400  # degrees of freedom up to which a structure that is no tube keeps all its modes
ZERO_SQUARE = 1.0e-14  # of the largest squared frequency: below it a mode is rigid-body motion
REPORT_STIFFNESS = (
    *(10.0**power for power in range(7)),
    4.0e6,
    1.0e7,
    1.0e8,
    1.0e9,
)  # N/m per support
REPORT_TO_HZ = 400.0
# Name of a basis -> (families, fraction of the free modes' cut-off that is kept).
REPORT_BASES = {
    "all": (FAMILIES, 1.0),
    **{f"{family} alone": ((family,), 1.0) for family in FAMILIES},
    **{
        f"without {family}": (tuple(other for other in FAMILIES if other != family), 1.0)
        for family in FAMILIES
    },
    "free_modes to a tenth": (FAMILIES, 0.1),
    **{
        f"free_modes to a tenth, without {family}": (
            tuple(other for other in FAMILIES if other != family),
            0.1,
        )
        for family in FAMILIES[1:]
    },
}


def build_model(config, motion_only=False):
    """Return the ModalModel of a configuration (parts structure, supports, elements, initial,
    damping, points, excitation, basis, record).

    motion_only: without the shape line and the stresses. Raises ValueError when a support or a
    named point is off the tube (farther than 5 mm), or a name is unknown.
    """
    tube = config.structure.kind in TUBES
    structure = build_structure(config) if tube else build_point_structure(config)
    place = _places(structure, config)
    structure = with_masses(structure, config.masses, place)
    local_rows = np.vstack(
        [
            element_rows(config.elements, place, structure.dofs),
            *(row[None] for row, _ in ([] if tube else structure.dampers)),
        ]
    )
    omega, shapes, full = _modes(structure, local_rows, config.basis)
    omega, order = with_factors(omega, config.mode_frequency_factors)
    shapes = shapes[:, order]
    damping = modal_damping(omega, config.damping)
    damper_shapes = np.zeros((len(omega), 0))
    coefficients = []
    if not tube:
        own, damper_shapes, coefficients = split_damping(shapes.T @ structure.damping @ shapes)
        damping = own + (
            0.0 if config.structure.kind == "identified" else damping
        )  # measured modes bring their own
        coefficients = [*(coefficient for _, coefficient in structure.dampers), *coefficients]
    names, laws = element_laws(config.elements, coefficients)
    contact = structure.contact
    fields = {
        "omega": omega,
        "damping": damping,
        "contact_shapes": np.einsum("cdn,nm->mcd", structure.contact_rows(), shapes),
        "contact_directions": contact.directions,
        "contact_weight": contact.weight,
        "support_of_point": contact.support,
        "support_names": tuple(support.name for support in config.supports),
        "contact_stiffness": contact.stiffness,
        "gap_factor": contact.gap_factor,
        "centre_offset": contact.centre_offset,
        "contact_position": contact.position,
        "contact_laws": contact_laws(config.supports, contact),
        "full_mode_frequencies": full,
        "drive_shapes": (force_row(structure, place, config.excitation, _axis(config)) @ shapes)[
            :, None
        ],
        "element_shapes": np.hstack([(local_rows @ shapes).T, damper_shapes]),
        "element_names": names,
        "local_laws": laws,
        "constant_force": dead_load(structure, place, config.excitation) @ shapes,
        "initial_displacement": _initial(structure, shapes, config.initial, "displacement_m"),
        "initial_velocity": _initial(structure, shapes, config.initial, "velocity_m_per_s"),
        **_sensor_fields(structure, shapes, config, place),
        **_line_fields(structure, shapes, config, tube and not motion_only),
        **_stress_fields(structure, shapes, config, tube and not motion_only),
    }
    if config.excitation.kind == "base_motion" and config.excitation.obstacles == "fixed":
        fields = with_base_mode(fields, config.excitation, config.initial)
    return ModalModel(**with_plates(fields, config.supports))


def _axis(config):
    """Return the axis about which the force is turned, where it is."""
    return (
        turn_axis(config, config.points[config.excitation.point])
        if getattr(config.excitation, "turn_deg", 0.0)
        else (0.0, 0.0, 1.0)
    )


def _places(structure, config):
    """Return the function name -> (3, dof): displacement rows of a named point."""
    if config.structure.kind in TUBES:
        return lambda name: structure.displacement_rows(named_arc_length(structure, config, name))
    return structure.point_rows


def _modes(structure, local_rows, basis):
    """Return (omega (mode,) rad/s, shapes (dof, mode), full_frequencies (mode,) Hz): all modes of a
    small point structure, or the Ritz basis.
    """
    rows = np.vstack([structure.contact_rows().reshape(-1, structure.dofs), local_rows])
    key = content_key(
        repr(basis),
        rows,
        *(
            array
            for matrix in map(sparse.csr_array, (structure.mass, structure.stiffness))
            for array in (matrix.data, matrix.indices, matrix.indptr)
        ),
    )
    return BASES.get(key, lambda: _modes_on(structure, rows, basis))


def _modes_on(structure, rows, basis):
    """Return what _modes does, for rows (row, dof) of contacts and elements."""
    groups = uncoupled_groups(structure.mass, structure.stiffness, rows)
    if not isinstance(structure, PointStructure) or structure.dofs > SMALL:
        omega, shapes = modal_basis(structure, groups, basis)
        free = [
            eigenmodes(group.stiffness, group.mass, basis.free_modes_to_Hz)[0] for group in groups
        ]
        return omega, shapes, np.sort(np.concatenate(free)) / (2.0 * np.pi)
    omega, shapes = np.zeros(structure.dofs), np.zeros((structure.dofs, structure.dofs))
    for group in groups:
        squares, inside = linalg.eigh(group.stiffness, group.mass)
        squares[squares < ZERO_SQUARE * max(squares[-1], 1.0e-300)] = 0.0
        omega[group.dofs] = np.sqrt(squares)
        shapes[np.ix_(group.dofs, group.dofs)] = inside
    order = np.argsort(omega, kind="stable")
    return omega[order], shapes[:, order], omega[order] / (2.0 * np.pi)


def _initial(structure, shapes, initial, key):
    """Return (mode,) the modal amplitudes of an initial field given at named points; zeros where
    nothing is given.
    """
    field = np.zeros(structure.dofs)
    for name, axes in getattr(initial, key).items() if initial is not None else ():
        for axis, value in axes.items():
            if axis not in structure.directions.get(name, {}):
                raise ValueError(
                    f"initial.{key}.{name}.{axis}: the structure has no such point or direction"
                )
            field[structure.directions[name][axis]] = value
    return shapes.T @ (structure.mass @ field)


def modal_basis(structure, groups, basis, families=FAMILIES):
    """Return (omega (mode,) rad/s ascending, shapes (dof, mode)) of the Ritz basis, each uncoupled
    group treated by itself.

    A shape is exactly 0.0 outside its group. Frequencies above basis.free_modes_to_Hz belong to
    what constrained modes and attachment shapes add to the free modes: they are residual vectors,
    not modes of the tube, and carry the local flexibility at the contacts.
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

    damping.kind modal: first_ratios for the first modes that are not rigid-body motion, other_ratio
    for the rest, and mass_coefficient. rayleigh: C = mass_coefficient M + stiffness_coefficient K,
    diagonal in this basis.
    """
    if damping.kind == "rayleigh":
        return damping.mass_coefficient_per_s + damping.stiffness_coefficient_s * omega**2
    ratios = np.full(len(omega), float(damping.other_ratio))
    elastic = np.flatnonzero(omega > 0.0)[: len(damping.first_ratios)]
    ratios[elastic] = damping.first_ratios[: len(elastic)]
    return 2.0 * ratios * omega + damping.mass_coefficient_per_s


def quality_report(config):
    """Return a list of rows (dict) that compare reduced with full frequencies, with bilateral
    contact from k = 1 to 1e9 N/m.

    Row keys: vectors ("all", "free_modes alone", ... see REPORT_BASES: what the basis is made of),
    modes (their number in the group), stiffness_N_per_m (per support), group (uncoupled group of
    dofs), mode (from 1, in its group), full_Hz, reduced_Hz (NaN where the basis has fewer modes),
    relative_error. Modes of the full model up to 400 Hz. A Ritz basis can only stiffen:
    relative_error is positive, but for the round-off of the full eigenvalues (about 1e-8).
    """
    if config.structure.kind not in TUBES:
        return []  # all modes are kept, or the user's matrices set the basis
    structure = build_structure(config)
    groups = uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows())
    share = np.sqrt(np.repeat(structure.contact.weight, 2))
    rows = []
    for number, group in enumerate(groups):
        contact = share[group.contact_rows][:, None] * group.contact
        bases = _report_bases(group, config.basis)
        for stiffness in REPORT_STIFFNESS:
            full = eigenmodes(
                group.stiffness + stiffness * contact.T @ contact, group.mass, REPORT_TO_HZ
            )[0] / (2.0 * np.pi)
            for name, basis in bases.items():
                reduced = _reduced_frequencies(basis, contact, stiffness, len(full))
                rows += [
                    {
                        "vectors": name,
                        "modes": len(basis[0]),
                        "stiffness_N_per_m": stiffness,
                        "group": number,
                        "mode": mode + 1,
                        "full_Hz": full[mode],
                        "reduced_Hz": reduced[mode],
                        "relative_error": reduced[mode] / full[mode] - 1.0,
                    }
                    for mode in range(len(full))
                ]
    return rows


def _report_bases(group, basis):
    """Return {name: (omega, shapes)}: the orthonormal bases of REPORT_BASES for one group."""
    vectors = basis_vectors(group, basis)
    free_Hz = eigenmodes(group.stiffness, group.mass, basis.free_modes_to_Hz)[0] / (2.0 * np.pi)
    bases = {}
    for name, (families, fraction) in REPORT_BASES.items():
        chosen = {family: vectors[family] for family in families if family in vectors}
        if "free_modes" in chosen:
            chosen["free_modes"] = chosen["free_modes"][
                :, free_Hz <= fraction * basis.free_modes_to_Hz
            ]
        bases[name] = orthonormal_basis(group, chosen)
    return bases


def _reduced_frequencies(basis, contact, stiffness, count):
    """Return (count,) Hz, NaN beyond the modes there are, of a basis (omega, shapes) on springs
    `stiffness` at `contact` rows.
    """
    omega, shapes = basis
    moved = contact @ shapes
    squares = (
        linalg.eigvalsh(np.diag(omega**2) + stiffness * moved.T @ moved)
        if len(omega)
        else np.zeros(0)
    )
    frequencies = np.full(count, np.nan)
    frequencies[: len(squares)] = np.sqrt(np.maximum(squares[:count], 0.0)) / (2.0 * np.pi)
    return frequencies


def named_arc_length(structure, config, name):
    """Return the arc length in m of a named point; raises ValueError for an unknown name or a point
    off the tube.
    """
    if name not in config.points:
        raise ValueError(f"point '{name}' is not among points: {', '.join(sorted(config.points))}")
    return structure.centreline.locate(config.points[name], f"point {name}")


def _sensor_fields(structure, shapes, config, place):
    """Return the fields of the sensors: every point of record.sensors in every direction, named
    "point.direction".

    Without record.sensors: every direction of every named point of a structure that is no tube.
    """
    tube = config.structure.kind in TUBES
    if config.record.sensors is not None:
        wanted = [
            (name, axis)
            for name in config.record.sensors.points
            for axis in config.record.sensors.directions
        ]
    else:
        wanted = (
            []
            if tube
            else [(name, axis) for name, axes in structure.directions.items() for axis in axes]
        )
    positions = [
        (
            structure.centreline.position(named_arc_length(structure, config, name))
            if tube
            else np.zeros(3)
        )
        for name, _ in wanted
    ]
    rows = [AXES[axis] @ place(name) for name, axis in wanted]
    return {
        "sensor_names": tuple(f"{name}.{axis}" for name, axis in wanted),
        "sensor_positions": np.array(positions).reshape(-1, 3),
        "sensor_directions": np.array([AXES[axis] for _, axis in wanted]).reshape(-1, 3),
        "sensor_shapes": (np.array(rows).reshape(-1, structure.dofs) @ shapes).T,
    }


def _line_fields(structure, shapes, config, wanted):
    """Return the fields of the shape line: points evenly spaced in arc length from end to end, the
    ends left out; none where not wanted.
    """
    if not wanted:
        return {
            "line_shapes": np.zeros((shapes.shape[1], 0)),
            "line_arc_length": np.zeros(0),
            "line_positions": np.zeros((0, 3)),
        }
    line = config.record.shape_line
    places = structure.centreline.length * np.arange(1, line.points + 1) / (line.points + 1)
    rows = np.array([AXES[line.direction] @ structure.displacement_rows(place) for place in places])
    return {
        "line_shapes": (rows @ shapes).T,
        "line_arc_length": places,
        "line_positions": np.array([structure.centreline.position(place) for place in places]),
    }


def _stress_fields(structure, shapes, config, wanted):
    """Return stress_shapes and section_names: both ends, edges and middle of each support, drive
    and sensor points; none where not wanted.

    Sections at the same place appear once, under the first name.
    """
    if not wanted:
        return {"section_names": (), "stress_shapes": np.zeros((shapes.shape[1], 0, 2))}
    places = {"root_start": 0.0, "root_end": structure.centreline.length}
    for number, support in enumerate(config.supports):
        points = structure.contact.arc_length[structure.contact.support == number]
        for part, place in (
            ("start", points[0]),
            ("middle", 0.5 * (points[0] + points[-1])),
            ("end", points[-1]),
        ):
            places[f"{support.name}_{part}"] = place
    driven = [config.excitation.point] if hasattr(config.excitation, "point") else []
    for name in (
        *driven,
        *(config.record.sensors.points if config.record.sensors is not None else ()),
    ):
        places[name] = named_arc_length(structure, config, name)
    names, kept = [], []
    for name, place in places.items():
        if all(abs(place - other) > SAME_PLACE_M for other in kept):
            names.append(name)
            kept.append(place)
    rows = np.array([structure.stress_rows(place) for place in kept])
    return {"section_names": tuple(names), "stress_shapes": np.einsum("sdn,nm->msd", rows, shapes)}
