"""Whether a peer solves the same problem: no time is quoted before its displacement agrees with
ours, without and with contact.
"""

from dataclasses import dataclass, replace

import numpy as np

from evidence.benchmarks import ours
from evidence.benchmarks.peer import Tolerance
from evidence.benchmarks.problem import RATE, STRIDE

CHECK_S, FIRST_IMPACTS_S = 0.05, 0.025
OFF_AXIS = 0.3  # of the gap
# of the largest displacement: a sensor that moves less is held to this instead of to its own
STILL = 0.01
BEYOND_S = 0.05  # the output filter of ours looks ahead: its force goes on
NAMES = ("linear", "first_impacts", "rms")


@dataclass(frozen=True)
class Agreement:
    """Differences of displacement at the SENSORS, as in Tolerance; NaN where there is none.
    failure: what a peer threw.
    """

    tolerance: Tolerance
    linear: float = float("nan")
    first_impacts: float = float("nan")
    rms: float = float("nan")
    failure: str = ""

    @property
    def passed(self):
        """Return True when every difference is within its tolerance."""
        return not self.failure and all(
            getattr(self, name) <= getattr(self.tolerance, name) for name in NAMES
        )

    def sentence(self):
        """Return the comparison in words."""
        if self.failure:
            return f"failed, its time is not quoted: {self.failure}"
        parts = [
            f"{name.replace('_', ' ')} {getattr(self, name):.1e} (tolerance"
            f" {getattr(self.tolerance, name):.0e})"
            for name in NAMES
        ]
        return (
            "agrees with ours: "
            if self.passed
            else "does NOT agree with ours, its time is not quoted: "
        ) + ", ".join(parts)


def agreement(peer, problem, seconds=CHECK_S):
    """Return the Agreement of a peer with ours over the first `seconds`; a batch runs the same
    force in every lane.

    The obstacles are moved off the tube's axis where the peer can have them so: contact then acts
    in both directions.
    """
    problem = problem if peer.centred else replace(problem, imperfection=OFF_AXIS)
    difference, reference = {}, {}
    for touching in (False, True):
        force = problem.force(seconds)
        batched = force if peer.batch == 1 else np.repeat(force[:, None], peer.batch, axis=1)
        theirs = peer.start(problem, touching).sampled(batched)
        whole = ours.displacement(
            peer.problem_of(problem), problem.force(seconds + BEYOND_S), seconds, touching
        )
        count = min(len(theirs), len(whole))
        largest = np.abs(whole).max(axis=0)
        scale = np.maximum(largest, STILL * largest.max())
        difference[touching], reference[touching] = (
            (theirs[:count] - whole[:count]) / scale,
            whole[:count] / scale,
        )
    first = round(FIRST_IMPACTS_S * RATE / STRIDE)
    rms = [
        np.sqrt(np.mean(values**2))
        for values in (reference[True], reference[True] + difference[True])
    ]
    return Agreement(
        peer.tolerance,
        linear=float(np.abs(difference[False]).max()),
        first_impacts=float(np.abs(difference[True][:first]).max()),
        rms=float(abs(rms[1] / rms[0] - 1.0)),
    )
