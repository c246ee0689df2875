"""Modes of a rig, to about 15 kHz, and everything the march needs of them; what the modes left out
still yield statically.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh

from vibroimpact_truth import kernel
from vibroimpact_truth.elements import Mesh
from vibroimpact_truth.geometry import named_places
from vibroimpact_truth.rig import LAWS, PROFILES

DRAG_STATIONS = 40
PLATE_DAMPING_RATIO = 0.02  # of a plate that yields
LANES = 8  # modes of a plane are filled up to a multiple


@dataclass(frozen=True, eq=False)
class Reduced:
    """What march needs, and the modes themselves, (mode,): omega2 rad²/s², rate = 2 zeta omega 1/s,
    frequency Hz, damping ratio, real False for the fillers of 1 Hz; the `split` modes of the "y"
    plane come first.
    """

    split: int
    omega2: np.ndarray
    rate: np.ndarray
    contacts: kernel.Contacts
    plates: np.ndarray
    local: kernel.Locals
    drive: np.ndarray
    other: np.ndarray
    dead: np.ndarray
    sensors: np.ndarray
    frequency: np.ndarray
    ratio: np.ndarray
    real: np.ndarray

    def turn(self, step):
        """(4, mode) exact motion of each mode over a step [s]."""
        return turn_of(self.omega2, self.rate, step)


def turn_of(omega2, rate, step):
    """(4, mode) exact drift of damped oscillators, omega2 rad²/s² and rate 2 zeta omega 1/s, over a
    step [s]; less than critical damping.
    """
    damped = np.sqrt(omega2 - 0.25 * rate**2)
    decay = np.exp(-0.5 * rate * step)
    sine, cosine = decay * np.sin(damped * step) / damped, decay * np.cos(damped * step)
    return np.array([cosine + 0.5 * rate * sine, sine, -omega2 * sine, cosine - 0.5 * rate * sine])


class Planes:
    """The finite-element matrices of a rig in both planes, with its springs, masses, fluid and
    roots.
    """

    def __init__(self, rig, element_length=0.036):
        self.rig, self.mesh = rig, Mesh(rig.tube, element_length)
        self.places = named_places(rig.tube)
        self.stiffness, self.mass, self.bare_mass = {}, {}, {}
        for plane in ("y", "x"):
            self.stiffness[plane], self.mass[plane] = self.mesh.matrices(plane, rig.fluid[0])
        for place, direction, value in rig.springs:
            self._add(self.stiffness, place, direction, value)
        for place, value in rig.masses:
            for direction in np.eye(3):
                self._add(self.mass, place, direction, value)
        last = 3 * self.mesh.nodes
        ends = {
            "y": ([0, last - 3], [1, 2, last - 2, last - 1]),
            "x": ([0, 1, last - 3, last - 2], [2, last - 1]),
        }
        self.free = {}
        for plane, (moves, turns) in ends.items():
            self.free[plane] = np.ones(last, bool)
            if rig.root is None:
                self.free[plane][moves + turns] = False
            else:
                self.stiffness[plane][moves, moves] += rig.root[0]
                self.stiffness[plane][turns, turns] += rig.root[1]

    def arc(self, place):
        """Arc length in m of a place: its name, or the arc length itself."""
        return self.places[place] if isinstance(place, str) else float(place)

    def _add(self, matrices, place, direction, value):
        for plane, row in self.rows(place, direction).items():
            if row.any():
                matrices[plane] += value * np.outer(row, row)

    def rows(self, place, direction):
        """{plane: (dof,)} displacement along direction (3,) at a place, or the rotation of the left
        root about "rx" or "ry".
        """
        size = 3 * self.mesh.nodes
        if isinstance(direction, str):
            rows = {"y": np.zeros(size), "x": np.zeros(size)}
            end = 0 if place == "left_root" else size - 3
            rows["y" if direction == "rx" else "x"][end + (1 if direction == "rx" else 2)] = 1.0
            return rows
        return dict(
            zip(("y", "x"), self.mesh.direction_rows(self.arc(place), direction), strict=True)
        )

    def modes(self, plane, highest=None, extra=()):
        """(mode,) frequencies [Hz] and (dof, mode) mass-normalised shapes up to `highest` Hz;
        extra: (row, N/m) springs.
        """
        free = self.free[plane]
        stiffness = self.stiffness[plane].copy()
        for row, value in extra:
            stiffness += value * np.outer(row, row)
        bounds = None if highest is None else (-1.0, (2.0 * np.pi * highest) ** 2)
        values, vectors = eigh(
            stiffness[np.ix_(free, free)],
            self.mass[plane][np.ix_(free, free)],
            subset_by_value=bounds,
        )
        shapes = np.zeros((len(free), len(values)))
        shapes[free] = vectors
        return np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi), shapes


def reduce_rig(rig, sensors, scatter=None, highest=15000.0):
    """The Reduced rig. sensors: (place, direction (3,)) of the accelerations; scatter: {frequency,
    damping: factor of a mode by its number from 0 in order of frequency} as functions of the number
    of modes, or None; highest: Hz of the last mode kept.
    """
    planes = Planes(rig)
    found = {plane: planes.modes(plane, highest) for plane in ("y", "x")}
    width = {plane: -(-len(found[plane][0]) // LANES) * LANES for plane in found}
    split, modes = width["y"], width["y"] + width["x"]
    where = {"y": slice(0, len(found["y"][0])), "x": slice(split, split + len(found["x"][0]))}
    frequency, real = np.ones(modes), np.zeros(modes, bool)
    for plane, part in where.items():
        frequency[part], real[part] = found[plane][0], True

    def project(rows):
        """(mode,) of a pair of rows by plane."""
        row = np.zeros(modes)
        for plane, part in where.items():
            row[part] = rows[plane] @ found[plane][1]
        return row

    ratio = _damping(rig, frequency, real)
    order = np.flatnonzero(real)[np.argsort(frequency[real])]
    for number, factor in rig.mode_factor.items():
        frequency[order[number - 1]] *= factor
    if scatter is not None:
        frequency[order] *= scatter["frequency"](len(order))
        ratio[order] *= scatter["damping"](len(order))
    omega = 2.0 * np.pi * frequency
    rate = 2.0 * ratio * omega
    if rig.fluid[1]:
        for plane, part in where.items():
            across = planes.mesh.matrices(plane, 1.0)[1] - planes.mesh.matrices(plane, 0.0)[1]
            rate[part] += rig.fluid[1] * np.einsum(
                "im,im->m", found[plane][1], across @ found[plane][1]
            )

    contacts = _contacts(planes, found, split, modes)
    plates = _plate_table(rig, contacts)
    dead = np.zeros(modes)
    for plate in rig.plates:
        middle = float(np.median(rig.tube.plate_nodes(plate.side)))
        dead += project(planes.rows(middle, (plate.preload[0], plate.preload[1], 0.0)))
    return Reduced(
        split,
        omega**2,
        rate,
        contacts,
        plates,
        _locals(planes, project),
        project(_drive_rows(planes)),
        project(planes.rows(*rig.unmeasured[:2])) if rig.unmeasured else np.zeros(modes),
        dead,
        np.array([project(planes.rows(place, direction)) for place, direction in sensors]),
        frequency,
        ratio,
        real,
    )


def _damping(rig, frequency, real):
    """(mode,) damping ratios: the first two modes of all, then the others."""
    ratio = np.full(len(frequency), rig.tube.other_damping)
    ratio[np.flatnonzero(real)[np.argsort(frequency[real])[:2]]] = rig.tube.first_damping
    return ratio * rig.damping_factor


def _drive_rows(planes):
    """Rows of the force: along y, turned by drive_angle about the tube's axis towards the outside
    of the bend.
    """
    rig = planes.rig
    tx, tz = rig.tube.tangent(planes.places["drive"])
    return planes.rows(
        "drive",
        (-np.sin(rig.drive_angle) * tz, np.cos(rig.drive_angle), np.sin(rig.drive_angle) * tx),
    )


def _contacts(planes, found, split, modes):
    """kernel.Contacts of all plates, with the static compliance that the modes kept do not have."""
    rig, plates = planes.rig, len(planes.rig.plates)
    lift = {plane: np.zeros((plates, kernel.SHAPES, kernel.NODES)) for plane in ("y", "x")}
    shape = {"y": np.zeros((kernel.ROWS, split)), "x": np.zeros((kernel.ROWS, modes - split))}
    residual = {plane: np.zeros((plates, kernel.NODES, kernel.NODES)) for plane in ("y", "x")}
    share, tilt = np.zeros((plates, kernel.NODES)), np.zeros((2, plates, kernel.NODES))
    for p, plate in enumerate(rig.plates):
        arcs = rig.tube.plate_nodes(plate.side)
        share[p, : len(arcs)] = 1.0 / len(arcs)
        tilt[:, p, : len(arcs)] = np.outer(
            plate.tilt, np.abs(arcs - arcs[0]) - 0.5 * abs(arcs[-1] - arcs[0])
        )
    for plane, direction in (("y", (0.0, 1.0, 0.0)), ("x", (1.0, 0.0, 0.0))):
        free = planes.free[plane]
        factor = cho_factor(planes.stiffness[plane][np.ix_(free, free)])
        frequency, shapes = found[plane]
        for p, plate in enumerate(rig.plates):
            arcs = rig.tube.plate_nodes(plate.side)
            nodes = slice(0, len(arcs))
            row = np.array([planes.rows(s, direction)[plane] for s in arcs])
            projected = row @ shapes
            residual[plane][p, nodes, nodes] = (
                row[:, free] @ cho_solve(factor, row[:, free].T)
                - (projected / (2.0 * np.pi * frequency) ** 2) @ projected.T
            )
            left, size, right = np.linalg.svd(projected, full_matrices=False)
            kept = min(
                kernel.SHAPES, len(size)
            )  # seven nodes within 30 mm follow four shapes to about 1e-5
            lift[plane][p, :kept, nodes] = left[:, :kept].T
            shape[plane][kernel.SHAPES * p : kernel.SHAPES * p + kept, : len(frequency)] = (
                size[:kept, None] * right[:kept]
            )
    return kernel.Contacts(
        lift["y"],
        lift["x"],
        share,
        residual["y"],
        residual["x"],
        tilt[1],
        tilt[0],
        shape["y"],
        shape["x"],
    )


def _plate_table(rig, contacts):
    """(plate, column) of kernel's columns; the gap is filled in per record."""
    table = np.zeros((len(rig.plates), kernel.PLATE_COLUMNS))
    for p, (row, plate) in enumerate(zip(table, rig.plates, strict=True)):
        rows = contacts.lift_y[p].T @ contacts.shape_y[kernel.SHAPES * p : kernel.SHAPES * (p + 1)]
        row[kernel.STIFFNESS], row[kernel.DAMPING] = plate.stiffness, plate.damping
        row[kernel.HUNT], row[kernel.HERTZ] = plate.hunt_crossley, plate.hertz
        row[kernel.MU], row[kernel.BRISTLE], row[kernel.SLIP_SPEED] = (
            plate.friction,
            plate.stick_ratio * plate.stiffness,
            plate.slip_speed,
        )
        row[kernel.MOBILITY] = np.linalg.eigvalsh(rows @ rows.T)[
            -1
        ]  # of the whole plate sliding at once, 1/kg
        row[kernel.GAP_RATE] = plate.gap_rate
        row[kernel.OFFSET_X], row[kernel.OFFSET_Y] = plate.offset
        row[kernel.PROFILE], row[kernel.LOBES], row[kernel.DEPTH] = (
            PROFILES[plate.profile],
            plate.lobes,
            plate.depth,
        )
        row[kernel.ANGLE], row[kernel.LAND] = plate.angle, plate.land_half_angle
        row[kernel.PLATE_MASS], row[kernel.PLATE_STIFFNESS] = (
            plate.plate_mass,
            plate.plate_stiffness,
        )
        row[kernel.PLATE_DAMPING] = (
            2.0 * PLATE_DAMPING_RATIO * np.sqrt(plate.plate_mass * plate.plate_stiffness)
        )
    return table


def _locals(planes, project):
    """kernel.Locals of the elements, loose masses and drag of a rig."""
    rig = planes.rig
    rows, laws, parameters = [], [], []
    for element in rig.elements:
        row = project(planes.rows(element.place, element.component))
        if element.other is not None:
            row = row - project(planes.rows(element.other, element.component))
        rows.append(row)
        laws.append(LAWS[element.law])
        parameters.append([*element.parameters, *[0.0] * (4 - len(element.parameters))])
    modes = len(project(planes.rows("apex", (0.0, 0.0, 0.0))))
    loose = np.array(
        [[mass.mass, mass.clearance, mass.stiffness, mass.damping] for mass in rig.loose]
    ).reshape(-1, 4)
    loose_rows = [
        np.array(
            [
                project(planes.rows(mass.place, _across(rig.tube, planes.arc(mass.place))[k]))
                for mass in rig.loose
            ]
        ).reshape(-1, modes)
        for k in range(2)
    ]
    stations = (
        (np.arange(DRAG_STATIONS) + 0.5) * rig.tube.length / DRAG_STATIONS if rig.drag else []
    )
    drag_rows = [
        np.array([project(planes.rows(s, _across(rig.tube, s)[k])) for s in stations]).reshape(
            -1, modes
        )
        for k in range(2)
    ]
    return kernel.Locals(
        np.array(laws, np.int64),
        np.array(parameters, float).reshape(-1, 4),
        np.array(rows, float).reshape(-1, modes),
        loose,
        loose_rows[0],
        loose_rows[1],
        np.full(len(stations), rig.drag * rig.tube.length / DRAG_STATIONS),
        *drag_rows,
    )


def _across(tube, s):
    """The two directions (3,) across the tube at arc length s [m]: out of plane and in plane."""
    tx, tz = tube.tangent(s)
    return (0.0, 1.0, 0.0), (tz, 0.0, -tx)
