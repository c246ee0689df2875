"""The compiled integration: kick, exact drift, kick. All compiled code of the package is here.

Per step h: v += h × (all forces at the present displacement); then every mode moves exactly as a
free damped oscillator. The scheme is symmetric, of second order, and symplectic where nothing is
lost; linear motion has no period error at any step. The contact force sees the displacement of the
modes plus the static compliance of those left out (`residual`), by two passes of a fixed-point
iteration with a contraction of about 0.03. Sources: E. Hairer, C. Lubich and G. Wanner, Geometric
Numerical Integration (2006), XIII.1 (impulse method); R. Bouc and Y.-K. Wen, J. Eng. Mech. 102
(1976) 249-263 (hysteresis). Friction: P. Dahl, AIAA J. 14 (1976) 1675-1682; C. Canudas de Wit et
al., IEEE Trans. Autom. Control 40 (1995) 419-425 (LuGre); W. Iwan, J. Appl. Mech. 33 (1966)
893-900; J. Antunes et al., J. Fluids Struct. 4 (1990) 287-304 (spring and damper that slide).
Damping of contacts: H. Lankarani and P. Nikravesh, J. Mech. Des. 112 (1990) 369-376; P. Flores et
al., Multibody Syst. Dyn. 25 (2011) 357-375.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

SHAPES = 4  # shapes that span the motion of a plate's nodes in one plane
ROWS = 8  # rows projected at once
PARTS = 4  # elements of a joint after Iwan
NODES = 8  # places for nodes of a plate
# m sqrt(kg): |q| at which the integration stops. The comparison is false for NaN, which isfinite
# does not detect with these compiler flags.
RUNAWAY = 1.0e6
# Without reference counting: nothing here allocates, and counting costs as much as the contact.
NRT = {"cache": True, "error_model": "numpy", "_nrt": False}
FAST = {"reassoc", "contract", "nsz", "arcp"}

# Columns of the table of plates.
STIFFNESS, DAMPING, HUNT, HERTZ, MU, BRISTLE, SLIP_SPEED, MOBILITY = 0, 1, 2, 3, 4, 5, 6, 7
GAP = 8
GAP_RATE = 9
OFFSET_X = 10
OFFSET_Y = 11
PROFILE = 12
LOBES = 13
DEPTH = 14
ANGLE = 15
LAND = 16
PLATE_MASS, PLATE_STIFFNESS, PLATE_DAMPING = 17, 18, 19
FRICTION_LAW = 20  # number of rig.FRICTION_LAWS
STATIC, STRIBECK_SPEED, STICK_TIME = 21, 22, 23
APPROACH = 24  # of the elastic force, per rate over the rate at first touch
LOOSENED_AT, LOOSENED_OVER, LOOSENED_BY = 25, 26, 27
PLATE_COLUMNS = 28
SLOWEST_APPROACH = 1.0e-4  # m/s: below it a contact counts as begun at this rate
LOOSE_MASS, LOOSE_GAP, LOOSE_STIFFNESS, LOOSE_DAMPING = 0, 1, 2, 3


class Contacts(NamedTuple):
    """Contact nodes, eight places per plate; unused ones have no share.

    The rows of a plate's nodes span few shapes: rows = lift × shape.

    lift_y, lift_x (plate, SHAPES, node).
    share (plate, node): of the plate's stiffness.
    residual_y, residual_x (plate, node, node): m/N.
    tilt_y, tilt_x (plate, node): offset of the hole's axis from the plate's centre, m.
    shape_y (row, y mode), shape_x (row, x mode): SHAPES rows per plate, a multiple of ROWS.
    """

    lift_y: np.ndarray
    lift_x: np.ndarray
    share: np.ndarray
    residual_y: np.ndarray
    residual_x: np.ndarray
    tilt_y: np.ndarray
    tilt_x: np.ndarray
    shape_y: np.ndarray
    shape_x: np.ndarray


class Locals(NamedTuple):
    """Local elements, loose masses and drag.

    law (element,), parameters (element, 4), row (element, mode).
    loose (mass, 4); loose_y, loose_x (mass, mode): rows along y and x.
    slider (mass, 4): kg, limit N, stick stiffness N/m, centring stiffness N/m; slider_row (mass,
    mode).
    drag (station,): N s²/m² per station; drag_y, drag_x (station, mode): rows across the tube,
    along y and in plane.
    """

    law: np.ndarray
    parameters: np.ndarray
    row: np.ndarray
    loose: np.ndarray
    loose_y: np.ndarray
    loose_x: np.ndarray
    slider: np.ndarray
    slider_row: np.ndarray
    drag: np.ndarray
    drag_y: np.ndarray
    drag_x: np.ndarray


class State(NamedTuple):
    """The variables that change with time.

    q, v (mode,). fx, fy (plate, node): contact force. bristle (plate, node, PARTS): deflections.
    was_x, was_y (plate, node): displacements from the plate's centre at the last step, m.
    approach (plate, node): rate at first touch, m/s, 0 where a node is free.
    memory (element,). plate (plate, 4) and loose (mass, 4): x, y and their rates. slider (mass, 3):
    displacement, rate and how far its bristle slid.

    Bristles are bent by displacements, not by sums of rates: these are rates before the kick of a
    step, and without half of each kick what sticks would be driven.
    """

    q: np.ndarray
    v: np.ndarray
    fx: np.ndarray
    fy: np.ndarray
    bristle: np.ndarray
    was_x: np.ndarray
    was_y: np.ndarray
    approach: np.ndarray
    memory: np.ndarray
    plate: np.ndarray
    loose: np.ndarray
    slider: np.ndarray


@njit(fastmath=FAST, **NRT, inline="always")
def obstacle(table, gap, x, y):
    """Penetration (negative when free) and outward normal of a plate's obstacle at (x, y).

    With lands, the one nearest to (x, y) counts.
    """
    radius = np.sqrt(x * x + y * y)
    kind = int(table[PROFILE])
    if kind == 0:
        if radius <= gap:
            return radius - gap, 1.0, 0.0
        return radius - gap, x / radius, y / radius
    lobes = table[LOBES]
    pitch = 2.0 * np.pi / lobes
    turn = np.arctan2(y, x) - table[ANGLE]
    nearest = np.round(turn / pitch) * pitch
    if kind == 1:
        nx, ny = np.cos(table[ANGLE] + nearest), np.sin(table[ANGLE] + nearest)
        return x * nx + y * ny - gap, nx, ny
    # Lobes: an arc of radius gap over each land, then a sine-squared recess of the depth between
    # the lands.
    off = turn - nearest
    beyond = abs(off) - table[LAND]
    edge, slope = gap, 0.0
    if beyond > 0.0:
        scale = 0.5 * np.pi / (0.5 * pitch - table[LAND])
        edge += table[DEPTH] * np.sin(scale * beyond) ** 2
        slope = table[DEPTH] * scale * np.sin(2.0 * scale * beyond) * np.sign(off)
    if radius <= edge or radius == 0.0:
        return radius - edge, 1.0, 0.0
    steep = slope / radius
    size = 1.0 / np.sqrt(1.0 + steep * steep)
    ux, uy = x / radius, y / radius
    return (radius - edge) * size, (ux + steep * uy) * size, (uy - steep * ux) * size


@njit(fastmath=FAST, **NRT, inline="always")
def gap_now(table, elapsed):
    """Radial clearance in m of a plate at a time of the campaign [s]: it drifts, and may loosen."""
    gap = table[GAP] * (1.0 + table[GAP_RATE] * elapsed)
    if table[LOOSENED_BY] != 0.0:
        done = (elapsed - table[LOOSENED_AT]) / table[LOOSENED_OVER]
        gap *= 1.0 + table[LOOSENED_BY] * min(max(done, 0.0), 1.0)
    return gap


@njit(fastmath=FAST, **NRT, inline="always")
def normal_force(table, share, depth, rate, approach):
    """Normal force in N, never tensile, of a node with a `share` of the plate.

    depth: penetration, m. rate: its rate, m/s. approach: its rate at first touch, m/s.
    """
    elastic = (
        table[STIFFNESS] * depth if table[HERTZ] == 0.0 else table[HERTZ] * depth * np.sqrt(depth)
    )
    loss = table[HUNT] * rate
    if table[APPROACH] != 0.0:
        loss += table[APPROACH] * rate / max(approach, SLOWEST_APPROACH)
    return max(0.0, share * (elastic * (1.0 + loss) + table[DAMPING] * rate))


@njit(fastmath=FAST, **NRT, inline="always")
def dahl(end, deflection, slip):
    """Deflection [m], `end` at most, of a Dahl bristle after a slip [m]: integrated exactly."""
    way = np.sign(slip)
    deflection = min(max(deflection, -end), end)
    return way * end + (deflection - way * end) * np.exp(-abs(slip) / end)


@njit(fastmath=FAST, **NRT, inline="always")
def friction_force(table, share, bristle, normal, slip, speed, step, keep):
    """Tangential force in N on the tube; bristle (PARTS,) is moved by a slip [m] where `keep`.

    speed: m/s, at the end of the step. law 0: a Dahl bristle. 1: Coulomb friction smoothed by tanh,
    limited so that it can not reverse the sliding within a step. 2: LuGre. 3: parallel Jenkins
    elements after Iwan. 4: a spring and damper that slide at the limit.
    """
    law = int(table[FRICTION_LAW])
    limit = table[MU] * normal
    if law == 1:
        return -np.sign(speed) * min(
            limit * np.tanh(abs(speed) / table[SLIP_SPEED]),
            0.5 * abs(speed) / (step * table[MOBILITY]),
        )
    if limit == 0.0:
        if keep:
            for part in range(PARTS):
                bristle[part] = 0.0
        return 0.0
    stiffness = share * table[BRISTLE]
    if law == 3:
        return jenkins_force(stiffness, limit, bristle, slip, keep)
    if law == 4:
        damper = table[STICK_TIME] * stiffness * speed
        force = stiffness * (bristle[0] + slip) + damper
        force = min(max(force, -limit), limit)
        if keep:
            bristle[0] = (force - damper) / stiffness
        return -force
    if law == 2:
        ratio = speed / table[STRIBECK_SPEED]
        limit *= 1.0 + (table[STATIC] - 1.0) * np.exp(-ratio * ratio)
    moved = dahl(limit / stiffness, bristle[0], slip)
    force = stiffness * moved
    if law == 2:
        force += table[STICK_TIME] * stiffness * (moved - bristle[0]) / step
    if keep:
        bristle[0] = moved
    return -force


@njit(fastmath=FAST, **NRT, inline="always")
def jenkins_force(stiffness, limit, bristle, slip, keep):
    """Force in N of PARTS equal springs in parallel, which slide at 0.4, 0.8, 1.2 and 1.6 of their
    share of the limit.
    """
    force, each = 0.0, stiffness / PARTS
    for part in range(PARTS):
        end = 0.4 * (part + 1) * limit / stiffness
        moved = min(max(bristle[part] + slip, -end), end)
        force += each * moved
        if keep:
            bristle[part] = moved
    return -force


@njit(fastmath=FAST, **NRT, inline="always")
def slid(displacement, way, slip, end):
    """How far [m] a Dahl bristle slid after a slip [m] to a displacement [m]; way: before it."""
    return displacement - dahl(end, displacement - way - slip, slip)


@njit(fastmath=FAST, **NRT, inline="always")
def element_force(law, p, d, v, memory, step, time):
    """Force in N (or N m) of a local element, and its memory after the step.

    law: number of rig.LAWS. p: its parameters. d, v: displacement and rate.

    linear k, c; cubic k3; quadratic k2; saturation k, limit (smooth); coulomb limit, bristle
    stiffness (its memory: how far it slid); clearance half gap, k; bouc_wen k, limit (makes the
    structure's spring k hysteretic); one_sided k, distance; drag c; self_excited a, b (a v - b v³);
    parametric k, frequency [Hz], phase [rad]; breathing k (taken from the structure while d > 0).
    """
    if law == 0:
        return -p[0] * d - p[1] * v, memory
    if law == 1:
        return -p[0] * d * d * d, memory
    if law == 2:
        return -p[0] * d * d, memory
    if law == 3:
        ratio = p[0] * d / p[1]
        return -p[0] * d / np.sqrt(1.0 + ratio * ratio), memory
    if law == 4:
        memory = slid(d, memory, step * v, p[0] / p[1])
        return -p[1] * (d - memory), memory
    if law == 5:
        over = max(0.0, d - p[0]) + min(0.0, d + p[0])
        return -p[1] * over, memory
    if law == 6:
        # z' = v (1 - (0.5 + 0.5 sign(v z)) (z / end)²) with z = d - memory; the structure's own
        # spring k d is removed
        share = (d - memory) * p[0] / p[1]
        memory += step * v * (0.5 + 0.5 * np.sign(v * share)) * share * share
        return p[0] * memory, memory
    if law == 7:
        return -p[0] * max(0.0, d - p[1]), memory
    if law == 8:
        return -p[0] * abs(v) * v, memory
    if law == 9:
        return p[0] * v - p[1] * v * v * v, memory
    if law == 10:
        return -p[0] * np.cos(2.0 * np.pi * p[1] * time + p[2]) * d, memory
    return p[0] * max(0.0, d), memory


@njit(fastmath=FAST, **NRT)
def dot(row, q):
    """Sum of row × q."""
    total = 0.0
    for m in range(len(q)):
        total += row[m] * q[m]
    return total


@njit(fastmath=FAST, **NRT)
def add(target, row, factor):
    """target += factor × row."""
    for m in range(len(target)):
        target[m] += factor * row[m]


@njit(fastmath=FAST, **NRT)
def project(rows, first, q, out):
    """out[first:first + 8] = eight of the rows × q, in one pass over the modes."""
    a = b = c = d = e = f = g = h = 0.0
    for m in range(len(q)):
        u = q[m]
        a += rows[first, m] * u
        b += rows[first + 1, m] * u
        c += rows[first + 2, m] * u
        d += rows[first + 3, m] * u
        e += rows[first + 4, m] * u
        f += rows[first + 5, m] * u
        g += rows[first + 6, m] * u
        h += rows[first + 7, m] * u
    out[first], out[first + 1], out[first + 2], out[first + 3] = a, b, c, d
    out[first + 4], out[first + 5], out[first + 6], out[first + 7] = e, f, g, h


@njit(fastmath=FAST, **NRT)
def advance(rows, q, v, turn, step, force, drive, extra, load, place):
    """Kick every mode, move it exactly, and project its new displacement on the eight rows.

    Plain form: v += step (force drive + extra + rows' load); q, v = turn (q, v); place = rows q.
    It is one pass, because memory access is what it costs.
    """
    a = b = c = d = e = f = g = h = 0.0
    l0 = load[0]
    l1 = load[1]
    l2 = load[2]
    l3 = load[3]
    l4 = load[4]
    l5 = load[5]
    l6 = load[6]
    l7 = load[7]
    for m in range(len(q)):
        r0 = rows[0, m]
        r1 = rows[1, m]
        r2 = rows[2, m]
        r3 = rows[3, m]
        r4 = rows[4, m]
        r5 = rows[5, m]
        r6 = rows[6, m]
        r7 = rows[7, m]
        kick = (
            force * drive[m]
            + extra[m]
            + l0 * r0
            + l1 * r1
            + l2 * r2
            + l3 * r3
            + l4 * r4
            + l5 * r5
            + l6 * r6
            + l7 * r7
        )
        u, w = q[m], v[m] + step * kick
        x = turn[0, m] * u + turn[1, m] * w
        q[m] = x
        v[m] = turn[2, m] * u + turn[3, m] * w
        a += r0 * x
        b += r1 * x
        c += r2 * x
        d += r3 * x
        e += r4 * x
        f += r5 * x
        g += r6 * x
        h += r7 * x
    place[0], place[1], place[2], place[3], place[4], place[5], place[6], place[7] = (
        a,
        b,
        c,
        d,
        e,
        f,
        g,
        h,
    )


@njit(fastmath=FAST, **NRT)
def add_loads(rows, load, extra, kick):
    """kick = extra + the load of the rows past the first eight, which `advance` does not take."""
    for m in range(len(kick)):
        kick[m] = extra[m]
    for k in range(ROWS, len(rows)):
        if load[k] != 0.0:
            add(kick, rows[k], load[k])


@njit(fastmath=FAST, **NRT)
def lift_to_nodes(lift, p, amplitude, nodes):
    """nodes[p, :] = displacement (or rate) of the nodes of plate p.

    amplitude (row,): of the shapes.
    """
    for i in range(NODES):
        nodes[p, i] = 0.0
    for k in range(SHAPES):
        factor = amplitude[SHAPES * p + k]
        for i in range(NODES):
            nodes[p, i] += lift[p, k, i] * factor


@njit(fastmath=FAST, **NRT)
def node_forces(
    table, share, gap, ux, uy, moved_x, moved_y, rate_x, rate_y, bristle, approach, step, keep
):
    """Force fx, fy in N on the tube of a node, and its rate of approach at first touch.

    ux, uy: from the plate's centre, m. moved_x, moved_y: since the last step, m. rate_x, rate_y:
    m/s. bristle (PARTS,) is moved where `keep`.
    """
    depth, nx, ny = obstacle(table, gap, ux, uy)
    if depth <= 0.0:
        if keep:
            for part in range(PARTS):
                bristle[part] = 0.0
        return 0.0, 0.0, 0.0
    rate = nx * rate_x + ny * rate_y
    slip = nx * moved_y - ny * moved_x
    if approach == 0.0:
        approach, slip = max(rate, SLOWEST_APPROACH), 0.0
    force = normal_force(table, share, depth, rate, approach)
    if table[MU] == 0.0:
        return -force * nx, -force * ny, approach
    speed = nx * rate_y - ny * rate_x
    along = friction_force(table, share, bristle, force, slip, speed, step, keep)
    return -force * nx - along * ny, -force * ny + along * nx, approach


@njit(fastmath=FAST, **NRT)
def contact_forces(
    contacts,
    plates,
    state,
    place_y,
    place_x,
    load_y,
    load_x,
    work,
    rates,
    elapsed,
    ramp,
    step,
    touching,
):
    """Set load_y, load_x (row,) to the forces of all contacts on the shapes.

    place_y, place_x (row,): displacements of the shapes.
    touching (plate,): set to 1.0 where a node touches, to 0.5 where one is inside without a force.
    work (6, plate, 8): displacements x and y, the same with the residual, rates x and y.
    rates (2, row): of the shapes, x and y.
    """
    ux = work[0]
    uy = work[1]
    ex = work[2]
    ey = work[3]
    wx = work[4]
    wy = work[5]
    rate_x = rates[0]
    rate_y = rates[1]
    fx, fy = state.fx, state.fy
    rates_known = False
    for k in range(len(load_y)):
        load_y[k] = 0.0
        load_x[k] = 0.0
    for p in range(len(plates)):
        lift_to_nodes(contacts.lift_x, p, place_x, ux)
        lift_to_nodes(contacts.lift_y, p, place_y, uy)
        shift_x = ramp * plates[p, OFFSET_X] + state.plate[p, 0]
        shift_y = ramp * plates[p, OFFSET_Y] + state.plate[p, 1]
        gap = gap_now(plates[p], elapsed)
        farthest = 0.0
        for i in range(NODES):
            ux[p, i] -= shift_x + ramp * contacts.tilt_x[p, i]
            uy[p, i] -= shift_y + ramp * contacts.tilt_y[p, i]
            farthest = max(farthest, ux[p, i] * ux[p, i] + uy[p, i] * uy[p, i])
        if farthest <= gap * gap and gap > 0.0 and touching[p] == 0.0:
            continue
        if (
            plates[p, DAMPING] != 0.0
            or plates[p, HUNT] != 0.0
            or plates[p, MU] != 0.0
            or plates[p, APPROACH] != 0.0
        ):
            if not rates_known:
                rates_known = True
                for first in range(0, len(rate_x), ROWS):
                    project(contacts.shape_x, first, state.v[contacts.shape_y.shape[1] :], rate_x)
                    project(contacts.shape_y, first, state.v[: contacts.shape_y.shape[1]], rate_y)
            lift_to_nodes(contacts.lift_x, p, rate_x, wx)
            lift_to_nodes(contacts.lift_y, p, rate_y, wy)
        touching[p] = 0.0
        for last in range(2):
            for i in range(NODES):
                ex[p, i], ey[p, i] = ux[p, i], uy[p, i]
            for j in range(NODES):
                for i in range(NODES):
                    ex[p, i] += contacts.residual_x[p, j, i] * fx[p, j]
                    ey[p, i] += contacts.residual_y[p, j, i] * fy[p, j]
            for i in range(NODES):
                fx[p, i], fy[p, i], approach = node_forces(
                    plates[p],
                    contacts.share[p, i],
                    gap,
                    ex[p, i],
                    ey[p, i],
                    ux[p, i] - state.was_x[p, i],
                    uy[p, i] - state.was_y[p, i],
                    wx[p, i] - state.plate[p, 2],
                    wy[p, i] - state.plate[p, 3],
                    state.bristle[p, i],
                    state.approach[p, i],
                    step,
                    last == 1,
                )
                if last:
                    state.approach[p, i] = approach
                    state.was_x[p, i], state.was_y[p, i] = ux[p, i], uy[p, i]
        for k in range(SHAPES):
            for i in range(NODES):
                load_x[SHAPES * p + k] += contacts.lift_x[p, k, i] * fx[p, i]
                load_y[SHAPES * p + k] += contacts.lift_y[p, k, i] * fy[p, i]
        for i in range(NODES):
            if fx[p, i] != 0.0 or fy[p, i] != 0.0:
                touching[p] = 1.0
            elif state.approach[p, i] != 0.0:
                touching[p] = max(touching[p], 0.5)


@njit(fastmath=FAST, **NRT)
def plate_resultants(state, resultant):
    """resultant (plate, 2) N: the forces of the plates on the tube."""
    for p in range(len(resultant)):
        resultant[p, 0], resultant[p, 1] = 0.0, 0.0
        for i in range(NODES):
            resultant[p, 0] += state.fx[p, i]
            resultant[p, 1] += state.fy[p, i]


@njit(fastmath=FAST, **NRT)
def plate_step(plates, state, step, resultant):
    """Kick and drift of every flexible plate, under the forces of the tube."""
    for p in range(len(plates)):
        table = plates[p]
        if table[PLATE_MASS] > 0.0:
            for k in range(2):
                load = (
                    -resultant[p, k]
                    - table[PLATE_STIFFNESS] * state.plate[p, k]
                    - table[PLATE_DAMPING] * state.plate[p, 2 + k]
                )
                state.plate[p, 2 + k] += step * load / table[PLATE_MASS]
                state.plate[p, k] += step * state.plate[p, 2 + k]


@njit(fastmath=FAST, **NRT)
def local_kick(local, state, kick, step, time):
    """Add the forces of local elements, drag and loose masses to the modal kick.

    Loose and sliding masses are kicked and moved here too.
    """
    for e in range(len(local.law)):
        force, state.memory[e] = element_force(
            local.law[e],
            local.parameters[e],
            dot(local.row[e], state.q),
            dot(local.row[e], state.v),
            state.memory[e],
            step,
            time,
        )
        add(kick, local.row[e], force)
    for s in range(len(local.drag)):
        wy, wx = dot(local.drag_y[s], state.v), dot(local.drag_x[s], state.v)
        factor = -local.drag[s] * np.sqrt(wx * wx + wy * wy)
        add(kick, local.drag_y[s], factor * wy)
        add(kick, local.drag_x[s], factor * wx)
    for b in range(len(local.loose)):
        mass = local.loose[b, 0]
        gap = local.loose[b, 1]
        stiffness = local.loose[b, 2]
        damping = local.loose[b, 3]
        x = state.loose[b, 0] - dot(local.loose_x[b], state.q)
        y = state.loose[b, 1] - dot(local.loose_y[b], state.q)
        radius = np.sqrt(x * x + y * y)
        if radius > gap:
            nx, ny = x / radius, y / radius
            rate = nx * (state.loose[b, 2] - dot(local.loose_x[b], state.v)) + ny * (
                state.loose[b, 3] - dot(local.loose_y[b], state.v)
            )
            force = max(0.0, stiffness * (radius - gap) + damping * rate)
            add(kick, local.loose_x[b], force * nx)
            add(kick, local.loose_y[b], force * ny)
            state.loose[b, 2] -= step * force * nx / mass
            state.loose[b, 3] -= step * force * ny / mass
        state.loose[b, 0] += step * state.loose[b, 2]
        state.loose[b, 1] += step * state.loose[b, 3]
    for b in range(len(local.slider)):
        speed = dot(local.slider_row[b], state.v) - state.slider[b, 1]
        apart, way = dot(local.slider_row[b], state.q) - state.slider[b, 0], state.slider[b, 2]
        way = slid(apart, way, step * speed, local.slider[b, 1] / local.slider[b, 2])
        state.slider[b, 2] = way
        force = local.slider[b, 2] * (apart - way) + local.slider[b, 3] * apart
        add(kick, local.slider_row[b], -force)
        state.slider[b, 1] += step * force / local.slider[b, 0]
        state.slider[b, 0] += step * state.slider[b, 1]


@njit(fastmath=FAST, cache=True, error_model="numpy")
def march(
    split,
    turn,
    contacts,
    plates,
    local,
    drive,
    force,
    other,
    unmeasured,
    dead,
    ramp,
    sensors,
    step,
    stride,
    start,
    state,
    out,
    reaction,
    touched,
):
    """Integrate len(force) steps; return the step at which the state diverged, or -1.

    split: number of the "y" modes, which come first.
    turn (4, mode): exact drift q' = t0 q + t1 v, v' = t2 q + t3 v.
    drive (mode,) and force (step,) N; other (mode,) and unmeasured (step or 0,) N: a second force.
    dead (mode,): dead load; ramp (step or 1,): its factor, and that of the offsets.
    sensors (channel, mode): a multiple of 8 channels.
    stride: steps per sample. start: time at the first step, s.
    out (sample, channel): displacements, m. reaction (sample, 2 plate): N.
    touched (plate,): increased by the steps in contact.
    """
    modes, count = len(state.q), len(plates)
    rows = len(contacts.shape_y)
    extra, work, rates = np.zeros(modes), np.zeros((6, max(count, 1), NODES)), np.zeros((2, rows))
    place_y = np.zeros(rows)
    place_x = np.zeros(rows)
    load_y = np.zeros(rows)
    load_x = np.zeros(rows)
    resultant, touching, sample = np.zeros((count, 2)), np.ones(count), np.zeros(len(sensors))
    qy, qx, vy, vx = state.q[:split], state.q[split:], state.v[:split], state.v[split:]
    turn_y, turn_x = turn[:, :split].copy(), turn[:, split:].copy()
    drive_y, drive_x, extra_y, extra_x = drive[:split], drive[split:], extra[:split], extra[split:]
    yields = False
    for p in range(count):
        yields |= plates[p, PLATE_MASS] > 0.0
    has_local = len(local.law) + len(local.drag) + len(local.loose) + len(local.slider) > 0
    more, kick_y, kick_x = rows > ROWS, np.zeros(split), np.zeros(modes - split)
    for first in range(0, rows, ROWS):
        project(contacts.shape_y, first, qy, place_y)
        project(contacts.shape_x, first, qx, place_x)
    for n in range(len(force)):
        scale = ramp[n] if len(ramp) > 1 else ramp[0]
        if n == 0 or has_local or len(ramp) > 1 or len(unmeasured):
            second = unmeasured[n] if len(unmeasured) else 0.0
            for m in range(modes):
                extra[m] = scale * dead[m] + second * other[m]
        contact_forces(
            contacts,
            plates,
            state,
            place_y,
            place_x,
            load_y,
            load_x,
            work,
            rates,
            start + n * step,
            scale,
            step,
            touching,
        )
        for p in range(count):
            touched[p] += touching[p] == 1.0
        if has_local:
            local_kick(local, state, extra, step, start + n * step)
        if n % stride == 0 and len(sensors):
            for first in range(0, len(sensors), ROWS):
                project(sensors, first, state.q, sample)
            plate_resultants(state, resultant)
            for c in range(len(sensors)):
                out[n // stride, c] = sample[c]
            for p in range(count):
                reaction[n // stride, 2 * p] = resultant[p, 0]
                reaction[n // stride, 2 * p + 1] = resultant[p, 1]
            if not abs(state.q[0]) < RUNAWAY:
                return n
        if yields:
            plate_resultants(state, resultant)
            plate_step(plates, state, step, resultant)
        if more:
            add_loads(contacts.shape_y, load_y, extra_y, kick_y)
            add_loads(contacts.shape_x, load_x, extra_x, kick_x)
        now_y, now_x = (kick_y, kick_x) if more else (extra_y, extra_x)
        advance(contacts.shape_y, qy, vy, turn_y, step, force[n], drive_y, now_y, load_y, place_y)
        advance(contacts.shape_x, qx, vx, turn_x, step, force[n], drive_x, now_x, load_x, place_x)
        for first in range(ROWS, rows, ROWS):
            project(contacts.shape_y, first, qy, place_y)
            project(contacts.shape_x, first, qx, place_x)
    return -1
