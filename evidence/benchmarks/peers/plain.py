"""The plain peer: the same step as a numba loop over one run, the way one would first write it
(benchmarks/plain_kernel.py).
"""

import numba
import numpy as np

from evidence.benchmarks.newmark import newmark_map
from evidence.benchmarks.peer import Marcher, Peer, Tolerance
from evidence.benchmarks.plain_kernel import march_plain
from evidence.benchmarks.problem import RATE, STRIDE

PASSES = 3


def peers():
    """Return [Peer]; numba is always there."""
    note = "the same reduced model, step and law; no output filter, statistics or energies"
    return [
        Peer("plain numba loop", numba.__version__, note, start, 1.0, Tolerance(), same_step=True)
    ]


def start(problem, touching=True):
    """Return the Marcher."""

    def march(force):
        return march_to_end(problem, force, touching)[0]

    def displacement(force):
        ends = [
            march_to_end(problem, force[: last + 1], touching)[0]
            for last in range(0, len(force), STRIDE)
        ]
        return np.array(ends) @ problem.sensor_shapes

    return Marcher(march, displacement)


def march_to_end(problem, force, touching=True, passes=PASSES):
    """Return (q, v), each (mode,), after the last value of force (step + 1,)."""
    model = problem.model
    coefficients = newmark_map(model.omega, model.damping, 1.0 / RATE)
    shapes = np.ascontiguousarray(model.contact_shapes.reshape(model.modes, -1).T)
    compliance = (shapes * coefficients[5]) @ shapes.T
    q, v = np.zeros(model.modes), np.zeros(model.modes)
    march_plain(
        shapes,
        model.drive_shapes[:, 0].copy(),
        coefficients,
        compliance,
        model.contact_stiffness,
        problem.contact_gap(touching),
        problem.offset.ravel(),
        force,
        q,
        v,
        passes,
    )
    return q, v
