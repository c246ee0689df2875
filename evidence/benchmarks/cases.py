"""Which code is measured on which problem, and what became of each."""

import importlib
from dataclasses import dataclass, replace

from evidence.benchmarks.check import NAMES, Agreement, agreement
from evidence.benchmarks.ours import contact_fraction
from evidence.benchmarks.pairs import measure_pairs
from evidence.benchmarks.peer import PeerAbsent
from evidence.benchmarks.problem import (
    FREE_MODES,
    LOAD_N,
    SMALL_BASIS,
    never_touching,
    tube_problem,
)

FILES = ("plain", "jax_scan", "exudyn_modal", "scipy_ivp", "diffrax_ode", "opensees")
# simulated per timed run of an explicit method where residual vectors of 130 kHz set its step:
# seconds each
EXPLICIT_S = 0.05


@dataclass(frozen=True)
class Case:
    """A problem (function), the files of benchmarks/peers measured on it, and whether the load
    reaches the obstacles.
    """

    problem: object
    files: tuple
    touches: bool = True


CASES = (
    Case(lambda: tube_problem(SMALL_BASIS), FILES),
    Case(tube_problem, ("plain", "jax_scan", "exudyn_modal")),
    Case(lambda: tube_problem(FREE_MODES, "free modes"), ("plain", "scipy_ivp", "diffrax_ode")),
    Case(lambda: never_touching(tube_problem()), ("plain", "jax_scan"), touches=False),
)


def available(files, say=print):
    """Return ({file: [Peer]}, [sentence about each that is absent])."""
    found, absent = {}, []
    for file in files:
        try:
            found[file] = importlib.import_module(f"evidence.benchmarks.peers.{file}").peers()
        except PeerAbsent as error:
            absent.append(f"{error}")
            say(f"skipped: {error}")
    return found, absent


def measure_case(case, found, clock, say=print):
    """Return ([Pair], [row of PEER_COLUMNS]): every available peer of the case checked, and those
    that agree measured.
    """
    problem = case.problem()
    chosen, rows = [], []
    for file in case.files:
        for peer in found.get(file, ()):
            peer = _shortened(peer, file, problem)
            found_out = _verdict(peer, problem, case.touches)
            say(f"{problem.name}: {peer.name} {found_out.sentence()}")
            rows.append(_row(problem, peer, clock.peer_scale * peer.seconds, found_out))
            if found_out.passed:
                chosen.append(peer)
    return measure_pairs(problem, chosen, clock, case.touches, say), rows


def _shortened(peer, file, problem):
    """Return the peer with a shorter timed run where an explicit method must follow residual
    vectors.
    """
    stiff = file in ("scipy_ivp", "diffrax_ode") and problem.config.basis.attachment_shapes
    return replace(peer, seconds=min(peer.seconds, EXPLICIT_S)) if stiff else peer


def _verdict(peer, problem, touches):
    """Return the Agreement of a peer, its own failures included."""
    try:
        # Where the load never touches, the check is made under the load that does: the same model,
        # and contact is what codes differ in.
        return agreement(peer, problem if touches else replace(problem, load_N=LOAD_N))
    except Exception as error:  # whatever another code throws, the rest is still measured
        return Agreement(
            peer.tolerance, failure=f"{type(error).__name__}: {error}".replace("\n", " ")
        )


def _row(problem, peer, seconds, found):
    """Return the row of PEER_COLUMNS."""
    return {
        "case": problem.name,
        "peer": peer.name,
        "version": peer.version,
        "simulated_s": seconds,
        "contact_fraction": contact_fraction(problem, seconds),
        **{name: getattr(found, name) for name in NAMES},
        **{f"{name}_tolerance": getattr(found.tolerance, name) for name in NAMES},
        "agrees": "yes" if found.passed else "no",
        "failure": found.failure,
        "note": peer.note,
    }
