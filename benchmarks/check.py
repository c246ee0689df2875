"""Whether a peer solves the same problem: no time is quoted before its displacement agrees with ours, without and with contact."""

from dataclasses import dataclass

import numpy as np

from benchmarks import ours
from benchmarks.peer import Tolerance
from benchmarks.problem import RATE, STRIDE

CHECK_S, FIRST_IMPACTS_S = 0.05, 0.025
NAMES = ("linear", "first_impacts", "rms")


@dataclass(frozen=True)
class Agreement:
    """Differences of displacement at the apex and at 45 degrees, as in Tolerance; NaN where there is none. failure: what a peer threw."""

    tolerance: Tolerance
    linear: float = float("nan")
    first_impacts: float = float("nan")
    rms: float = float("nan")
    failure: str = ""

    @property
    def passed(self):
        """Return True when every difference is within its tolerance."""
        return not self.failure and all(getattr(self, name) <= getattr(self.tolerance, name) for name in NAMES)

    def sentence(self):
        """Return the comparison in words."""
        if self.failure:
            return f"failed, its time is not quoted: {self.failure}"
        parts = [f"{name.replace('_', ' ')} {getattr(self, name):.1e} (tolerance {getattr(self.tolerance, name):.0e})" for name in NAMES]
        return ("agrees with ours: " if self.passed else "does NOT agree with ours, its time is not quoted: ") + ", ".join(parts)


def agreement(peer, problem, seconds=CHECK_S):
    """Return the Agreement of a peer with ours over the first `seconds`; a batch runs the same force in every lane."""
    apart = {}
    for touching in (False, True):
        force = problem.force(seconds)
        batched = force if peer.batch == 1 else np.repeat(force[:, None], peer.batch, axis=1)
        theirs = peer.start(problem, touching).sampled(batched)
        reference = ours.displacement(peer.problem_of(problem), force, seconds, touching)
        count = min(len(theirs), len(reference))
        apart[touching] = theirs[:count] - reference[:count], reference[:count]
    largest = np.abs(apart[False][1]).max(), np.abs(apart[True][1]).max()
    first = round(FIRST_IMPACTS_S * RATE / STRIDE)
    values = {"linear": np.abs(apart[False][0]).max() / largest[0], "first_impacts": np.abs(apart[True][0][:first]).max() / largest[1],
              "rms": abs(np.sqrt(np.mean((apart[True][0] + apart[True][1]) ** 2) / np.mean(apart[True][1] ** 2)) - 1.0)}  # fmt: skip
    return Agreement(peer.tolerance, **{name: float(value) for name, value in values.items()})
