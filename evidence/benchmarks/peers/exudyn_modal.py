"""Exudyn: its general second-order object on the modes, Newmark with modified Newton, force and
contact in a user function compiled by numba.
"""

import sys
from contextlib import redirect_stdout
from io import StringIO

import numpy as np
from numba import njit

from evidence.benchmarks.peer import INSTALL, Marcher, Peer, PeerAbsent, Tolerance
from evidence.benchmarks.problem import RATE, STRIDE

# relative and absolute tolerance of the residual, both of the size that Exudyn starts from (1e-8
# costs a quarter more)
NEWTON = 1.0e-5


def peers():
    """Return [Peer]. Raises PeerAbsent."""
    exudyn = _exudyn()
    note = (
        "the same reduced model, step and law, the matrices sparse (its fastest setting here);"
        " coordinates kept every 25 steps"
    )
    return [
        Peer("Exudyn, modal", exudyn.__version__, note, start, 0.2, Tolerance(), same_step=True)
    ]


def start(problem, touching=True):
    """Return the Marcher; it builds the system anew at every call (milliseconds)."""
    model = problem.model
    constants = (
        np.ascontiguousarray(model.contact_shapes.reshape(model.modes, -1).T),
        model.drive_shapes[:, 0].copy(),
        model.contact_stiffness,
        problem.contact_gap(touching),
        problem.offset.ravel(),
    )

    def march(force):
        def push(_system, t, _number, q, _velocity):
            return _modal_force(t, np.asarray(q), force, *constants)

        system, sensor = _system(_exudyn(), model, push)
        system.SolveDynamic(
            _settings(_exudyn(), len(force) - 1),
            solverType=_exudyn().DynamicSolverType.GeneralizedAlpha,
        )
        return system.GetSensorStoredData(sensor)[:, 1:] @ problem.sensor_shapes

    return Marcher(march)


def _exudyn():
    sys.exudynFast = True  # its build without range checks
    try:
        with redirect_stdout(StringIO()):
            import exudyn
            import exudyn.itemInterface
    except ImportError as error:
        raise PeerAbsent(f"Exudyn cannot be imported ({error}): {INSTALL}") from error
    return exudyn


def _system(exudyn, model, push):
    """Return (system, sensor number): q'' + damping q' + omega² q = push(...)."""
    items, rest = exudyn.itemInterface, np.zeros(model.modes)
    system = exudyn.SystemContainer().AddSystem()
    node = system.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=rest,
            initialCoordinates=rest,
            initialCoordinates_t=rest,
            numberOfODE2Coordinates=model.modes,
        )
    )
    system.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=[node],
            massMatrix=_diagonal(exudyn, np.ones(model.modes)),
            stiffnessMatrix=_diagonal(exudyn, model.omega**2),
            dampingMatrix=_diagonal(exudyn, model.damping),
            forceUserFunction=push,
        )
    )
    sensor = system.AddSensor(
        items.SensorNode(
            nodeNumber=node,
            storeInternal=True,
            outputVariableType=exudyn.OutputVariableType.Coordinates,
        )
    )
    system.Assemble()
    return system, sensor


def _diagonal(exudyn, values):
    """Return a sparse diagonal matrix as Exudyn takes it."""
    from scipy.sparse import diags

    matrix = exudyn.MatrixContainer()
    matrix.SetWithSparseMatrix(diags(values).tocsr(), len(values), len(values))
    return matrix


def _settings(exudyn, steps):
    """Return the settings of a run: average acceleration, the Jacobian of the modes alone, no
    files, no printing.
    """
    settings = exudyn.SimulationSettings()
    march = settings.timeIntegration
    march.numberOfSteps, march.endTime, march.verboseMode = steps, steps / RATE, 0
    march.generalizedAlpha.useNewmark = True  # beta 1/4, gamma 1/2 by default
    march.newton.useModifiedNewton = True
    march.newton.absoluteTolerance = march.newton.relativeTolerance = NEWTON
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = STRIDE / RATE
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    settings.show.computationTime = settings.show.statistics = False
    settings.parallel.numberOfThreads = 1
    return settings


@njit(cache=True, fastmath=True)
def _modal_force(t, q, force, shapes, drive, stiffness, gap, offset):
    out = drive * force[min(int(t * RATE + 0.5), force.size - 1)]
    for p in range(stiffness.size):
        d1, d2 = -offset[2 * p], -offset[2 * p + 1]
        for i in range(q.size):
            d1 += shapes[2 * p, i] * q[i]
            d2 += shapes[2 * p + 1, i] * q[i]
        distance = np.sqrt(d1 * d1 + d2 * d2)
        if distance > gap:
            k = -stiffness[p] * (distance - gap) / distance
            for i in range(q.size):
                out[i] += k * (d1 * shapes[2 * p, i] + d2 * shapes[2 * p + 1, i])
    return out
