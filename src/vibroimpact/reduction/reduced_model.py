"""The reduced model of a configuration: structure -> Ritz basis -> ModalModel."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from scipy import linalg, sparse

from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.excitation.fluid_rows import fluid_fields
from vibroimpact.excitation.force_vectors import constant_force_vector, force_vector, turn_axis
from vibroimpact.excitation.turbulence import drive_shapes
from vibroimpact.geometry.centreline import SAME_PLACE_M
from vibroimpact.io.memo import Memo, content_key
from vibroimpact.structure.contact.local_elements import element_laws, element_rows, split_damping
from vibroimpact.structure.contact.supports import contact_laws, contact_preload
from vibroimpact.structure.definiteness import require_definite
from vibroimpact.structure.point_structure import PointStructure, build_point_structure
from vibroimpact.structure.rigid_motions import free_rigid_motions
from vibroimpact.structure.tube import TubeStructure, build_structure

from .basis import Basis
from .initial_state import initial_state
from .modal_model import ModalModel
from .ritz_basis import (
    DofGroup,
    basis_vectors,
    group_numbers,
    orthonormal_basis,
    rigid_body_shift,
    uncoupled_groups,
)
from .structural_modifications import (
    with_base_mode,
    with_frequency_factors,
    with_point_masses,
    with_support_plates,
)

BASES = Memo()
AXES = dict(zip("xyz", np.eye(3), strict=True))
MAX_FULL_DOFS = 400  # a structure other than a tube keeps all its modes up to this size
UNHELD = 1.0e-6  # of the largest modal force: more than this on a mode without stiffness pushes it
ZERO_SQUARE = 1.0e-14  # of the largest squared frequency; below it a mode is rigid-body motion


def build_model(
    config: ConfigPart,
    motion_only: bool = False,
    gauges: Sequence[tuple[str, np.ndarray]] = (),
    basis: Basis | None = None,
) -> ModalModel:
    """Return the ModalModel of a configuration.

    config: parts structure, supports, elements, masses, initial, damping, points, excitation, flow,
        basis and record.
    motion_only: leave out the shape line and the stresses.
    gauges: (named point, outward normal (3,)) of strain gauges on a tube. Each is one more sensor
        behind those of record.sensors, its shape a strain per unit amplitude.
    basis: of another configuration, see reduced_basis: the structure is built on its mesh and
        reduced on it; a new basis is made if None, or if it does not span the motion. A variant
        that differs in point masses, local elements, stops at a point or springs in place of clamps
        needs no mesh and no basis of its own.

    Raises ValueError when a support or a named point is more than 5 mm off the tube, a name is
    unknown, no mode is left, round-off hides a stiffness (see _refuse_false_rigid_modes), a preload
    has no static equilibrium, or the initial state is not representable (see initial_state).
    """
    structure, local_rows = full_structure(config, nodes=None if basis is None else basis.nodes)
    point_rows = point_rows_of(structure, config)
    tube = config.structure.kind in TUBES
    known = None if basis is None else basis.shapes_of(structure)
    if known is not None:
        omega, shapes = _modes_in(structure, local_rows, known)
        full_frequencies = omega / (2.0 * np.pi)
    else:
        omega, shapes, full_frequencies = _modes(structure, local_rows, config)
    if not len(omega):
        raise ValueError(
            f"basis.free_modes_to_Hz = {config.basis.free_modes_to_Hz:g}: the structure has no mode"
            " up to there, and no contact: raise it"
        )
    if tube:
        _refuse_false_rigid_modes(structure, omega, config)
    omega, order = with_frequency_factors(omega, config.mode_frequency_factors)
    shapes = shapes[:, order]
    fields = {
        "omega": omega,
        "full_mode_frequencies": full_frequencies,
        **_damping_and_element_fields(structure, omega, shapes, local_rows, config),
        **_contact_fields(structure, shapes, config),
        **_force_fields(structure, omega, shapes, config, point_rows),
        **(fluid_fields(structure, shapes, omega, config) if tube else {}),
        **initial_state(structure, shapes, len(full_frequencies), config.initial, point_rows),
        **_sensor_fields(structure, shapes, config, point_rows, gauges),
    }
    if tube and not motion_only:
        fields |= _line_fields(structure, shapes, config)
        fields |= _stress_fields(structure, shapes, config)
    if config.excitation.kind == "base_motion" and config.excitation.obstacles == "fixed":
        fields = with_base_mode(fields, config.excitation, config.initial)
    fields = with_support_plates(fields, config.supports, config.excitation)
    model = ModalModel(**fields)
    _refuse_unheld_preload(model)
    return model


def full_structure(
    config: ConfigPart, halved: bool = False, nodes: np.ndarray | None = None
) -> tuple[Any, np.ndarray]:
    """Return (TubeStructure or PointStructure with its point masses, rows of the local elements).

    The rows are (row, dof), relative displacements of the elements and of the dampers of a chain.

    halved, nodes: of a tube's mesh, see structure.tube.build_structure.

    Raises ValueError, see build_model.
    """
    if config.structure.kind in TUBES:
        structure: Any = build_structure(config, halved, nodes)
    else:
        structure = build_point_structure(config)
    point_rows = point_rows_of(structure, config)
    dampers = getattr(structure, "dampers", [])
    own_rows = element_rows(config.elements, point_rows, structure.dofs)
    local_rows = np.vstack([own_rows, *(row for row, _ in dampers)])
    return with_point_masses(structure, config.masses, point_rows), local_rows


def spring_rows(structure: Any, local_rows: np.ndarray) -> np.ndarray:
    """Return (spring, dof) displacements of the contacts, two directions each, and elements."""
    return np.vstack([structure.contact_rows().reshape(-1, structure.dofs), local_rows])


def reduced_basis(config: ConfigPart) -> Basis:
    """Return the Basis of a configuration before any correction."""
    structure, local_rows = full_structure(config)
    omega, shapes, _ = _modes(structure, local_rows, config)
    return Basis(structure, omega, shapes)


def _refuse_false_rigid_modes(
    structure: TubeStructure, omega: np.ndarray, config: ConfigPart
) -> None:
    """Raise ValueError when more modes have no stiffness than the ends of the tube leave free.

    The round-off of elements that are very short compared with the tube then exceeds its
    stiffness. The message names the shortest one.
    """
    allowed = free_rigid_motions(config.structure, structure.centreline)
    found = int(np.sum(omega == 0.0))
    if found <= allowed:
        return
    ends = [getattr(config.structure, name, None) for name in ("root", "start", "end")]
    soft = any(end is not None and end.kind == "springs" for end in ends)
    lengths = np.diff(structure.node_arc_length)
    shortest = int(np.argmin(lengths))
    raise ValueError(
        f"the reduced model has {found} modes without stiffness, the ends of the tube allow"
        f" {allowed}: the shortest element, {lengths[shortest]:.3g} m at arc length"
        f" {structure.node_arc_length[shortest]:.4f} m, is too short compared with the tube of"
        f" {structure.centreline.length:.4g} m: give the support there fewer points or more"
        " height_m, move it, or use structure.theory: timoshenko"
        + (", or give the ends springs that are not so soft" if soft else "")
    )


def _refuse_unheld_preload(model: ModalModel) -> None:
    """Raise ValueError when preloads push a mode that has no stiffness."""
    force = np.abs(model.preload_force)
    if force[model.omega == 0.0].max(initial=0.0) > UNHELD * force.max(initial=0.0):
        raise ValueError(
            "supports: preload_N presses a structure that can move freely in its direction, it has"
            " no static equilibrium: hold an end of it, or press from both sides"
        )


def _damping_and_element_fields(
    structure: Any,
    omega: np.ndarray,
    shapes: np.ndarray,
    local_rows: np.ndarray,
    config: ConfigPart,
) -> dict[str, Any]:
    """Return the fields of the modal damping and of the local elements.

    Damping that couples the modes becomes linear dampers, which are local elements too.
    """
    damping = modal_damping(omega, config.damping)
    damper_shapes = np.zeros((len(omega), 0))
    coefficients: list[float] = []
    if config.structure.kind in TUBES:
        damping = damping + structure.fluid_damping(omega, shapes)
    else:
        diagonal, damper_shapes, added = split_damping(shapes.T @ structure.damping @ shapes)
        # Measured modes bring their damping with them.
        damping = diagonal + (0.0 if config.structure.kind == "identified" else damping)
        coefficients = [*(coefficient for _, coefficient in structure.dampers), *added]
    names, laws = element_laws(config.elements, coefficients)
    return {
        "damping": damping,
        "element_shapes": np.hstack([(local_rows @ shapes).T, damper_shapes]),
        "element_names": names,
        "local_laws": laws,
    }


def _contact_fields(structure: Any, shapes: np.ndarray, config: ConfigPart) -> dict[str, Any]:
    """Return the fields of the contact points."""
    contact = structure.contact
    return {
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
        "preload": contact_preload(config.supports, contact),
    }


def _force_fields(
    structure: Any, omega: np.ndarray, shapes: np.ndarray, config: ConfigPart, point_rows: Callable
) -> dict[str, Any]:
    """Return the fields of the case's force and of the constant force."""
    if config.excitation.kind == "turbulence":
        driven = drive_shapes(structure, shapes, omega, config.excitation)
    else:
        nowhere = (0.0, 0.0, 0.0)  # not used for the axis of a structure other than a tube
        place = config.points.get(getattr(config.excitation, "point", None), nowhere)
        axis = turn_axis(config, place)
        force = force_vector(structure, point_rows, config.excitation, axis)
        driven = (force @ shapes)[:, None]
    constant = constant_force_vector(structure, point_rows, config.excitation)
    return {"drive_shapes": driven, "constant_force": constant @ shapes}


def point_rows_of(structure: Any, config: ConfigPart) -> Callable[[str], np.ndarray]:
    """Return the function of a point's name that gives its displacement rows (3, dof)."""
    if config.structure.kind in TUBES:
        return cache(
            lambda name: structure.displacement_rows(named_arc_length(structure, config, name))
        )
    return structure.point_rows


def _modes(
    structure: Any, local_rows: np.ndarray, config: ConfigPart
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (omega (mode,) rad/s, shapes (dof, mode), full frequencies (mode,) Hz).

    A small point structure keeps all its modes; any other is reduced to the Ritz basis.

    Raises IndefiniteMatrixError.
    """
    basis = config.basis
    rows = spring_rows(structure, local_rows)
    matrices = map(sparse.csr_array, (structure.mass, structure.stiffness))
    arrays = [array for each in matrices for array in (each.data, each.indices, each.indptr)]
    key = content_key(repr(basis), rows, *arrays)
    names = ("structure.masses", "structure.springs")
    if config.structure.kind == "matrices":
        names = (str(config.structure.mass), str(config.structure.stiffness))
    return BASES.get(key, lambda: _modes_on(structure, rows, basis, names))


def _modes_in(
    structure: Any, local_rows: np.ndarray, basis: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return (omega (mode,) rad/s, shapes (dof, mode)) of the modes within a basis (dof, vector).

    A vector is exactly 0.0 outside its uncoupled group, and so are the shapes.
    """
    rows = spring_rows(structure, local_rows)
    mass, stiffness = map(sparse.csr_array, (structure.mass, structure.stiffness))
    arrays = [array for each in (mass, stiffness) for array in (each.data, each.indices)]
    return BASES.get(
        content_key("within", basis, group_numbers(mass, stiffness, rows), *arrays),
        lambda: _within(uncoupled_groups(mass, stiffness, rows), basis),
    )


def _within(groups: Sequence[DofGroup], basis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the modes of _modes_in, of uncoupled groups."""
    parts = []
    for group in groups:
        own = basis[:, np.any(basis[group.dofs] != 0.0, axis=0)]
        inside = own[group.dofs]
        if not inside.size:
            continue
        # for the flexibility, as in ritz_basis.eigenmodes: the lowest modes lose no digits
        stiffness, mass = inside.T @ group.stiffness @ inside, inside.T @ group.mass @ inside
        shift = rigid_body_shift(stiffness, mass)
        flexibility, turn = linalg.eigh(mass, stiffness + shift * mass)
        omega = np.sqrt(np.maximum(1.0 / flexibility[::-1] - shift, 0.0))
        shapes = np.zeros_like(own)
        shapes[group.dofs] = inside @ (turn / np.sqrt(flexibility))[:, ::-1]
        parts.append((omega, shapes))
    return _ascending(parts)


def keeps_all_modes(structure: Any) -> bool:
    """Return whether a structure is so small that its model has all its modes."""
    return isinstance(structure, PointStructure) and structure.dofs <= MAX_FULL_DOFS


def _modes_on(
    structure: Any, rows: np.ndarray, basis: ConfigPart, names: tuple[str, str]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the modes of _modes, for rows (row, dof) of contacts and elements."""
    groups = uncoupled_groups(structure.mass, structure.stiffness, rows)
    if isinstance(structure, PointStructure):
        require_definite(((each.dofs, each.mass, each.stiffness) for each in groups), names)
    if not keeps_all_modes(structure):
        # Frequencies above free_modes_to_Hz are those of residual vectors, not of modes: they carry
        # the local flexibility at the contacts.
        parts = []
        for group in groups:
            omega, inside = orthonormal_basis(group, basis_vectors(group, basis))
            shapes = np.zeros((structure.dofs, len(omega)))  # exactly 0 outside the group
            shapes[group.dofs] = inside
            parts.append((omega, shapes))
        omega, shapes = _ascending(parts)
        free = [group.free_modes(basis.free_modes_to_Hz)[0] for group in groups]
        return omega, shapes, np.sort(np.concatenate(free)) / (2.0 * np.pi)
    omega, shapes = np.zeros(structure.dofs), np.zeros((structure.dofs, structure.dofs))
    for group in groups:
        squares, inside = linalg.eigh(group.stiffness, group.mass)
        # The negative ones are round-off: require_definite has refused any other.
        squares[squares < ZERO_SQUARE * max(squares[-1], 1.0e-300)] = 0.0
        omega[group.dofs] = np.sqrt(squares)
        shapes[np.ix_(group.dofs, group.dofs)] = inside
    omega, shapes = _ascending([(omega, shapes)])
    return omega, shapes, omega / (2.0 * np.pi)


def _ascending(parts: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return the modes (omega (mode,), shapes (dof, mode)) of all parts, in ascending frequency."""
    omega, shapes = (np.concatenate(columns, axis=-1) for columns in zip(*parts, strict=True))
    order = np.argsort(omega, kind="stable")
    return omega[order], shapes[:, order]


def modal_damping(omega: np.ndarray, damping: ConfigPart) -> np.ndarray:
    """Return (mode,) 2 zeta omega in 1/s for ascending omega (mode,) in rad/s.

    damping.kind modal: first_ratios for the first modes that are not rigid-body motion, other_ratio
        for the rest, and mass_coefficient.
    damping.kind rayleigh: C = mass_coefficient M + stiffness_coefficient K, diagonal in this basis.
    """
    if damping.kind == "rayleigh":
        return damping.mass_coefficient_per_s + damping.stiffness_coefficient_s * omega**2
    ratios = np.full(len(omega), float(damping.other_ratio))
    elastic = np.flatnonzero(omega > 0.0)[: len(damping.first_ratios)]
    ratios[elastic] = damping.first_ratios[: len(elastic)]
    return 2.0 * ratios * omega + damping.mass_coefficient_per_s


def named_arc_length(structure: TubeStructure, config: ConfigPart, name: str) -> float:
    """Return the arc length in m of a named point.

    Raises ValueError for an unknown name or a point off the tube.
    """
    if name not in config.points:
        raise ValueError(f"point '{name}' is not among points: {', '.join(sorted(config.points))}")
    return structure.centreline.locate(config.points[name], f"point {name}")


def _sensor_fields(
    structure: Any,
    shapes: np.ndarray,
    config: ConfigPart,
    point_rows: Callable,
    gauges: Sequence[tuple[str, np.ndarray]],
) -> dict[str, Any]:
    """Return the fields of the sensors, "point.direction", and "point.strain" of the gauges.

    Without record.sensors, a structure other than a tube has one for every direction of every
    named point.
    """
    sensors, places = config.record.sensors, getattr(structure, "directions", {})
    named = places if sensors is None else dict.fromkeys(sensors.points, sensors.directions)
    wanted = [(name, axis) for name, axes in named.items() for axis in axes]
    positions = [np.array(config.points.get(name, (0.0, 0.0, 0.0))) for name, _ in wanted]
    if config.structure.kind in TUBES:
        place_of = cache(lambda name: named_arc_length(structure, config, name))
        positions = [structure.centreline.position(place_of(name)) for name, _ in wanted]
    rows = [AXES[axis] @ point_rows(name) for name, axis in wanted]
    directions = [AXES[axis] for _, axis in wanted]
    for name, normal in gauges:
        place = named_arc_length(structure, config, name)
        positions.append(structure.centreline.position(place))
        directions.append(np.asarray(normal, float))
        rows.append(structure.strain_row(place, normal))
    return {
        "sensor_names": (
            *(f"{name}.{axis}" for name, axis in wanted),
            *(f"{name}.strain" for name, _ in gauges),
        ),
        "sensor_positions": np.array(positions).reshape(-1, 3),
        "sensor_directions": np.array(directions).reshape(-1, 3),
        "sensor_shapes": (np.array(rows).reshape(-1, structure.dofs) @ shapes).T,
    }


def _line_fields(structure: Any, shapes: np.ndarray, config: ConfigPart) -> dict[str, Any]:
    """Return the fields of the shape line.

    Its points are evenly spaced in arc length between the ends of the tube, ends excluded.
    """
    line = config.record.shape_line
    places = structure.centreline.length * np.arange(1, line.points + 1) / (line.points + 1)
    rows = np.array([AXES[line.direction] @ structure.displacement_rows(place) for place in places])
    return {
        "line_shapes": (rows @ shapes).T,
        "line_arc_length": places,
        "line_positions": np.array([structure.centreline.position(place) for place in places]),
    }


def _stress_fields(structure: Any, shapes: np.ndarray, config: ConfigPart) -> dict[str, Any]:
    """Return stress_shapes and section_names.

    Sections are at both ends of the tube, at the edges and middle of each support, at the drive
    point and at the sensors. Sections at the same place appear once, under the first name.
    """
    places = {"root_start": 0.0, "root_end": structure.centreline.length}
    for number, support in enumerate(config.supports):
        points = structure.contact.arc_length[structure.contact.support == number]
        places[f"{support.name}_start"] = points[0]
        places[f"{support.name}_middle"] = 0.5 * (points[0] + points[-1])
        places[f"{support.name}_end"] = points[-1]
    driven = [config.excitation.point] if hasattr(config.excitation, "point") else []
    sensors = config.record.sensors.points if config.record.sensors is not None else ()
    for name in (*driven, *sensors):
        places[name] = named_arc_length(structure, config, name)
    sections: dict[str, float] = {}
    for name, place in places.items():
        if all(abs(place - other) > SAME_PLACE_M for other in sections.values()):
            sections[name] = place
    rows: dict[str, np.ndarray] = {}
    for name, place in sections.items():
        rows |= _outer_fibre_rows(structure, name, place)
    return {
        "section_names": tuple(rows),
        "stress_shapes": np.einsum("sdn,nm->msd", np.array(list(rows.values())), shapes),
    }


def _outer_fibre_rows(structure: TubeStructure, name: str, place: float) -> dict[str, np.ndarray]:
    """Return {name: (2, dof)} of the stresses in Pa at an arc length in m whose root of the sum of
    squares is that of the outermost fibre.

    A round section has one entry, the two bending stresses: its worst fibre turns with the bending
    moment. Any other has two, name_corner_1 and name_corner_2, at which the two bending stresses
    add up and subtract. At the opposite corners they are the same with the other sign.
    """
    rows = structure.stress_rows(place)
    if structure.first_axis is None:
        return {name: rows}
    nothing = np.zeros(structure.dofs)
    return {
        f"{name}_corner_1": np.array([rows[0] + rows[1], nothing]),
        f"{name}_corner_2": np.array([rows[0] - rows[1], nothing]),
    }
