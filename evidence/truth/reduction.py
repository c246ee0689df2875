"""Modal model of a rig: modes up to about 15 kHz, and residual compliance of all higher ones."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from evidence.truth import kernel
from evidence.truth.planes import BEND, Planes
from evidence.truth.rig import FRICTION_LAWS, LAWS, PROFILES

DRAG_STATIONS = 40
PLATE_DAMPING_RATIO = 0.02  # of a flexible plate
OUT = np.array([0.0, 1.0, 0.0])  # out of plane
LANES = 8  # the number of modes of a plane is padded to a multiple of this


@dataclass(frozen=True, eq=False)
class Reduced:
    """A modal model: the arguments of kernel.march, and the modes.

    split: number of modes of the "y" plane, which come first.
    omega2 (mode,): rad²/s². rate (mode,): 2 zeta omega, 1/s.
    frequency (mode,): Hz. ratio (mode,): damping ratio.
    real (mode,): False for padding modes of 1 Hz.
    drift: relative change of all frequencies per s of the campaign.
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
    drift: float = 0.0

    def propagator(self, step, elapsed=0.0):
        """(4, mode) exact free motion of each mode over a step [s], at a time of the campaign."""
        factor = 1.0 + self.drift * elapsed
        return exact_propagator(factor**2 * self.omega2, factor * self.rate, step)


def exact_propagator(omega2, rate, step):
    """(4, mode) exact free motion of damped oscillators over a step [s].

    omega2 (mode,): rad²/s². rate (mode,): 2 zeta omega, 1/s, less than critical.
    """
    damped = np.sqrt(omega2 - 0.25 * rate**2)
    decay = np.exp(-0.5 * rate * step)
    sine, cosine = decay * np.sin(damped * step) / damped, decay * np.cos(damped * step)
    return np.array([cosine + 0.5 * rate * sine, sine, -omega2 * sine, cosine - 0.5 * rate * sine])


def reduce_rig(rig, sensors, scatter=None, highest=15000.0):
    """The Reduced model of a rig.

    sensors: (place, direction (3,)) of the accelerations.
    scatter: {"frequency", "damping": function of the number of modes that returns a factor for each
    mode in order of frequency}, or None.
    highest: Hz, of the last mode.
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
        across = rig.tube.across(middle)
        dead += project(planes.rows(middle, plate.preload[0] * across + plate.preload[1] * OUT))
    return Reduced(
        split,
        omega**2,
        rate,
        contacts,
        plates,
        _locals(planes, project, omega**2),
        project(_drive_rows(planes)),
        project(planes.rows(*rig.unmeasured[:2])) if rig.unmeasured else np.zeros(modes),
        dead,
        np.array([project(planes.rows(place, direction)) for place, direction in sensors]),
        frequency,
        ratio,
        real,
        rig.frequency_drift,
    )


def _damping(rig, frequency, real):
    """(mode,) damping ratios: one for the two lowest modes, one for all others."""
    ratio = np.full(len(frequency), rig.tube.other_damping)
    ratio[np.flatnonzero(real)[np.argsort(frequency[real])[:2]]] = rig.tube.first_damping
    return ratio * rig.damping_factor


def _drive_rows(planes):
    """Rows of the force: along its direction, turned by drive_angle about the tube's axis. Of a
    moving base those of the inertia of what it carries, per m/s²."""
    rig = planes.rig
    if rig.on_base:
        return {plane: -row for plane, row in planes.carried(rig.drive_direction).items()}
    tx, tz = rig.tube.tangent(planes.places["drive"])
    axis, force = np.array([tx, 0.0, tz]), np.array(rig.drive_direction)
    angle = rig.drive_angle
    along = axis @ force * axis
    # y towards (-tz, 0, tx), the outer side of a bend
    turned = np.cos(angle) * (force - along) + np.sin(angle) * np.cross(axis, force)
    return planes.rows("drive", along + turned)


def _contacts(planes, found, split, modes):
    """kernel.Contacts of all plates, with the static compliance of the modes left out."""
    rig, plates = planes.rig, len(planes.rig.plates)
    lift = {plane: np.zeros((plates, kernel.SHAPES, kernel.NODES)) for plane in ("y", "x")}
    rows = kernel.ROWS * max(1, -(-kernel.SHAPES * plates // kernel.ROWS))
    shape = {"y": np.zeros((rows, split)), "x": np.zeros((rows, modes - split))}
    residual = {plane: np.zeros((plates, kernel.NODES, kernel.NODES)) for plane in ("y", "x")}
    share, tilt = np.zeros((plates, kernel.NODES)), np.zeros((2, plates, kernel.NODES))
    for p, plate in enumerate(rig.plates):
        arcs = rig.tube.plate_nodes(plate.side)
        share[p, : len(arcs)] = 1.0 / len(arcs)
        tilt[:, p, : len(arcs)] = np.outer(
            plate.tilt, np.abs(arcs - arcs[0]) - 0.5 * abs(arcs[-1] - arcs[0])
        )
    for plane in ("y", "x"):
        free = planes.free[plane]
        factor = cho_factor(planes.stiffness[plane][np.ix_(free, free)])
        frequency, shapes = found[plane]
        for p, plate in enumerate(rig.plates):
            arcs = rig.tube.plate_nodes(plate.side)
            nodes = slice(0, len(arcs))
            direction = OUT if plane == "y" else rig.tube.across(float(np.median(arcs)))
            row = np.array([planes.rows(s, direction)[plane] for s in arcs])
            projected = row @ shapes
            residual[plane][p, nodes, nodes] = (
                row[:, free] @ cho_solve(factor, row[:, free].T)
                - (projected / (2.0 * np.pi * frequency) ** 2) @ projected.T
            )
            left, size, right = np.linalg.svd(projected, full_matrices=False)
            # The motion of seven nodes within 30 mm is spanned by four shapes, to about 1e-5.
            kept = min(kernel.SHAPES, len(size))
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
        row[kernel.APPROACH], row[kernel.MU] = plate.approach_damping, plate.friction
        row[kernel.FRICTION_LAW] = FRICTION_LAWS[plate.friction_law]
        row[kernel.BRISTLE] = plate.stick_ratio * plate.stiffness
        row[kernel.SLIP_SPEED], row[kernel.STATIC] = plate.slip_speed, plate.static_ratio
        row[kernel.STRIBECK_SPEED], row[kernel.STICK_TIME] = plate.stribeck_speed, plate.stick_time
        row[[kernel.LOOSENED_AT, kernel.LOOSENED_OVER, kernel.LOOSENED_BY]] = plate.loosened
        # 1/kg, of all nodes of the plate sliding at once
        row[kernel.MOBILITY] = np.linalg.eigvalsh(rows @ rows.T)[-1]
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


def _crack(tube, compliance, flexibility):
    """Stiffness N m/rad that an open crack takes from the bending angle over BEND m.

    compliance: of the crack, rad/(N m). flexibility: of the angle in the modes kept, which can not
    bend as sharply as the beam: with it, the compliance of the whole is right.
    """
    taken = compliance * (tube.section["EI"] / BEND) ** 2
    return taken / (1.0 + taken * flexibility)


def _locals(planes, project, omega2):
    """kernel.Locals of the elements, loose and sliding masses and drag of a rig."""
    rig = planes.rig
    rows, laws, parameters = [], [], []
    for element in rig.elements:
        row = project(planes.rows(element.place, element.component))
        if element.other is not None:
            row = row - project(planes.rows(element.other, element.component))
        rows.append(row)
        laws.append(LAWS[element.law])
        given = element.parameters
        if element.law == "breathing":
            given = (_crack(rig.tube, given[0], np.sum(row**2 / omega2)),)
        parameters.append([*given, *[0.0] * (4 - len(given))])
    modes = len(project(planes.rows("drive", (0.0, 0.0, 0.0))))
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
    sliders = np.array(
        [[mass.mass, mass.limit, mass.stick, mass.centring] for mass in rig.sliders]
    ).reshape(-1, 4)
    slider_rows = np.array(
        [project(planes.rows(mass.place, mass.direction)) for mass in rig.sliders]
    ).reshape(-1, modes)
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
        sliders,
        slider_rows,
        np.full(len(stations), rig.drag * rig.tube.length / DRAG_STATIONS),
        *drag_rows,
    )


def _across(tube, s):
    """The two directions (3,) across the tube at arc length s [m]: out of plane and in plane."""
    tx, tz = tube.tangent(s)
    return (0.0, 1.0, 0.0), (tz, 0.0, -tx)
