"""SciPy's solve_ivp with a right-hand side compiled by numba: RK45 and LSODA."""

import numpy as np
import scipy
from numba import njit
from scipy.integrate import solve_ivp

from evidence.benchmarks.peer import Marcher, Peer, Tolerance
from evidence.benchmarks.problem import RATE, STRIDE

RELATIVE, ABSOLUTE = (
    1.0e-6,
    (
        1.0e-9,
        1.0e-6,
    ),
)  # of displacement (kg^1/2 m) and velocity (kg^1/2 m/s)


def peers():
    """Return [Peer]; SciPy is always there."""
    note = (
        "the same reduced model and law; step chosen by the solver, rtol 1e-6, the force linear"
        " between the steps of ours"
    )
    tolerance = Tolerance()
    return [
        Peer(f"SciPy {method}", scipy.__version__, note, starter(method), 0.1, tolerance)
        for method in ("RK45", "LSODA")
    ]


def starter(method):
    """Return the start function of a solver of solve_ivp."""

    def start(problem, touching=True):
        right_hand_side = modal_slope(problem, touching)
        modes = problem.model.modes
        absolute = np.repeat(ABSOLUTE, modes)

        def march(force):
            last = (len(force) - 1) / RATE
            samples = np.minimum(np.arange(0, len(force), STRIDE) / RATE, last)
            found = solve_ivp(
                right_hand_side,
                (0.0, last),
                np.zeros(2 * modes),
                method,
                samples,
                args=(force,),
                rtol=RELATIVE,
                atol=absolute,
            )
            if not found.success:
                raise RuntimeError(f"solve_ivp {method}: {found.message}")
            return found.y[:modes].T @ problem.sensor_shapes

        return Marcher(march)

    return start


def modal_slope(problem, touching):
    """Return f(t, y, force) -> (2 mode,): the derivative of y = (q, v)."""
    model = problem.model
    constants = (
        model.omega**2,
        model.damping,
        np.ascontiguousarray(model.contact_shapes.reshape(model.modes, -1).T),
        model.drive_shapes[:, 0].copy(),
        model.contact_stiffness,
        problem.contact_gap(touching),
        problem.offset.ravel(),
    )
    return lambda t, y, force: _slope(t, y, force, *constants)


@njit(cache=True, fastmath=True)
def _slope(t, y, force, square, damping, shapes, drive, stiffness, gap, offset):
    modes = square.size
    place = min(max(t * RATE, 0.0), force.size - 1.0)
    first = min(int(place), force.size - 2)
    f = force[first] + (place - first) * (force[first + 1] - force[first])
    out = np.empty(2 * modes)
    for i in range(modes):
        out[i] = y[modes + i]
        out[modes + i] = drive[i] * f - damping[i] * y[modes + i] - square[i] * y[i]
    for p in range(stiffness.size):
        d1, d2 = -offset[2 * p], -offset[2 * p + 1]
        for i in range(modes):
            d1 += shapes[2 * p, i] * y[i]
            d2 += shapes[2 * p + 1, i] * y[i]
        distance = np.sqrt(d1 * d1 + d2 * d2)
        if distance > gap:
            k = -stiffness[p] * (distance - gap) / distance
            for i in range(modes):
                out[modes + i] += k * (d1 * shapes[2 * p, i] + d2 * shapes[2 * p + 1, i])
    return out
