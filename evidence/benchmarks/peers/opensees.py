"""OpenSees: beam elements with consistent mass and gap springs, Newmark, modified Newton on a
matrix that is factorised once.
"""

from dataclasses import replace
from functools import cache

import numpy as np

from evidence.benchmarks.peer import INSTALL, Marcher, Peer, PeerAbsent, Tolerance
from evidence.benchmarks.problem import RATE, SMALL_BASIS, STRIDE, tube_problem
from evidence.validation.judges import opensees as judges_opensees
from evidence.validation.judges.presence import JudgeAbsent, opensees

MASS_PER_S, STIFFNESS_S = 1.0, 2.0e-6  # Rayleigh: modal damping would fill OpenSees' matrices
MESH = {
    "structure.mesh.elements_per_span": 5,
    "structure.mesh.elements_per_bend": 20,
}  # 282 equations, few for the tube's 0 to 7500 Hz
RAYLEIGH = {
    "damping": {
        "kind": "rayleigh",
        "mass_coefficient_per_s": MASS_PER_S,
        "stiffness_coefficient_s": STIFFNESS_S,
    }
}
LAST_INCREMENT_M, NEWTON_PASSES = 1.0e-9, 50
ALONG, ACROSS = 1, 2  # OpenSees' numbers of x and y


def peers():
    """Return [Peer]. Raises PeerAbsent."""
    try:
        opensees()
    except JudgeAbsent as error:
        raise PeerAbsent(
            f"{str(error).partition(':')[0]}: {INSTALL}; its compiled part needs Python 3.11 on"
            " Linux"
        ) from error
    from importlib.metadata import version

    note = (
        "finite elements, 49 nodes, 282 equations, Rayleigh damping; gap springs along x and y, a"
        " square hole in place of a round one (the same while the tube moves across its plane, as"
        " here); the matrix factorised once, three times faster than its plain Newton"
    )
    return [
        Peer(
            "OpenSees, beams",
            version("openseespy"),
            note,
            start,
            0.05,
            Tolerance(),
            centred=True,
            problem_of=twin,
        )
    ]


def twin(problem):
    """Return the Problem of ours with OpenSees' mesh and damping."""
    return replace(problem, config=_twin().config, model=_twin().model)


@cache
def _twin():
    return tube_problem({**SMALL_BASIS, **MESH, **RAYLEIGH})


def start(problem, touching=True):
    """Return the Marcher; it builds the tube anew at every call (milliseconds)."""
    ops, config = opensees(), twin(problem).config

    def march(force):
        nodes = judges_opensees.clamped_tube(ops, config, 1)
        _gap_springs(ops, nodes, config.supports[0], problem.contact_gap(touching))
        ops.rayleigh(MASS_PER_S, 0.0, STIFFNESS_S, 0.0)
        ops.timeSeries("Path", 1, "-dt", 1.0 / RATE, "-values", *map(float, force))
        ops.pattern("Plain", 1, 1)
        driven = judges_opensees.NODES_FROM + nodes.drive
        ops.load(driven, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
        apex = judges_opensees.NODES_FROM + int(np.argmax(nodes.position[:, 2]))
        return _march(ops, ((apex, ALONG), (apex, ACROSS), (driven, ACROSS)), len(force) - 1)

    return Marcher(march)


def _gap_springs(ops, nodes, support, gap):
    """Two gap springs back to back along x and along y at every contact point; the peer's obstacles
    are centred.
    """
    stiffness = support.stiffness_N_per_m / support.points
    for number, node in enumerate(nodes.contact):
        above, below = 2 * number + 1001, 2 * number + 1002
        ops.uniaxialMaterial("ElasticPPGap", above, stiffness, judges_opensees.NEVER_N, gap)
        ops.uniaxialMaterial("ElasticPPGap", below, stiffness, -judges_opensees.NEVER_N, -gap)
        ops.uniaxialMaterial("Parallel", number + 1, above, below)
        judges_opensees.tie(ops, nodes, number, node, (ALONG, ACROSS))


def _march(ops, watched, steps):
    """Return (sample, watched) m; watched: (node, direction)."""
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandSPD")
    ops.test("NormDispIncr", LAST_INCREMENT_M, NEWTON_PASSES)
    ops.algorithm("ModifiedNewton", "-initial", "-factorOnce")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    seen = [[0.0] * len(watched)]
    for _ in range(steps // STRIDE):
        if ops.analyze(STRIDE, 1.0 / RATE) != 0:
            raise RuntimeError("OpenSees: Newton did not settle")
        seen.append([ops.nodeDisp(*place) for place in watched])
    ops.wipe()
    return np.array(seen)
