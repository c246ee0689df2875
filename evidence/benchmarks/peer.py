"""What every code that is measured against offers."""

from collections.abc import Callable
from dataclasses import dataclass

INSTALL = "make benchmark installs it, from requirements-benchmark.lock"


class PeerAbsent(Exception):
    """A peer that cannot be imported; the message says so and how to get it."""


def itself(problem):
    """Return the problem as it is."""
    return problem


@dataclass(frozen=True)
class Marcher:
    """A peer set up for one problem, started from rest at every call.

    march: force (step + 1,) N, or (step + 1, batch), at k / RATE: what is timed. displacement: the
    same force -> (sample, sensor) m at the SENSORS, every STRIDE-th step; None: march returns it
    (of its first run where there are several).
    """

    march: Callable
    displacement: Callable = None

    def sampled(self, force):
        """Return (sample, sensor) m."""
        return (self.displacement or self.march)(force)


@dataclass(frozen=True)
class Tolerance:
    """What a peer's displacement may differ by, each sensor relative to its own largest value in
    ours.

    linear: without contact; first_impacts: up to FIRST_IMPACTS_S; rms: RMS over the whole check.
    Impacts multiply small differences, and the records of ours have passed the output filter, which
    takes 1e-3 of the displacement out of an impact.
    """

    linear: float = 1.0e-3
    first_impacts: float = 5.0e-3
    rms: float = 5.0e-3


@dataclass(frozen=True)
class Peer:
    """A code and how it is used. start: (problem, touching) -> Marcher; touching False: the same
    force, the obstacles out of reach.

    seconds: simulated per timed run; batch: runs side by side; same_step: integrates with the
    project's own step, so that nanoseconds per step compare; centred: its obstacles cannot be moved
    off the tube's axis; note: what it solves, and where that differs; problem_of: problem -> the
    problem whose answer of ours it is checked against.
    """

    name: str
    version: str
    note: str
    start: Callable
    seconds: float
    tolerance: Tolerance
    batch: int = 1
    same_step: bool = False
    centred: bool = False
    problem_of: Callable = itself
