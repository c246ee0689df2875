"""How the project's cost grows: with modes, contact points, supports, runs side by side and duration."""

from dataclasses import dataclass

import numpy as np

from benchmarks.ours import contact_fraction, march_ours, schedule_of
from benchmarks.pairs import our_cost
from benchmarks.problem import FREE_MODES, RATE, SMALL_BASIS, tube_problem

MODES_TO_HZ = (1000.0, 3000.0, 5000.0, 7500.0, 12000.0)
POINTS = (1, 3, 5, 9)
SUPPORTS = (1, 2, 4, 6)
BATCHES = (1, 2, 4, 8, 16, 32)
DURATIONS_S = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
BATCH = 8
HEIGHTS_M = (0.35, 0.20, 0.50)  # of the plates, on either leg in turns
STATISTICS_S = 0.5


@dataclass(frozen=True)
class Growth:
    """One point of a curve: what is varied, its value, what was run, and the cost (repeat,) in s per simulated s and run."""

    varied: str
    value: float
    modes: int
    contact_points: int
    supports: int
    batch: int
    duration_s: float
    contact_fraction: float
    cost: list
    clock: str = "CPU"

    @property
    def ns_per_step(self):
        """Return (repeat,) ns per step and run."""
        return 1.0e9 * np.array(self.cost) / RATE


def growth_points(clock, quick=False, say=print):
    """Yield the Growth of every curve. Repeats in turns over the points of a curve, so that a machine's moods fall on all of them."""
    for varied, cases in _curves(quick).items():
        points = [(value, problem, batch, seconds, our_cost(problem, batch, seconds)) for value, problem, batch, seconds in cases]
        costs = [[] for _ in points]
        for repeat in range(clock.repeats + 1):
            for cost, (*_, measure) in zip(costs, points, strict=True):
                found = measure()
                if repeat > 0:  # the first compiles and fills the caches
                    cost.append(found)
        for cost, (value, problem, batch, seconds, _) in zip(costs, points, strict=True):
            model = problem.model
            yield Growth(varied, value, model.modes, len(model.support_of_point), len(model.support_names), batch, seconds, touching(problem), cost)
        say(f"growth with {varied}: " + ", ".join(f"{point[0]:g}: {1e9 * np.median(cost) / RATE:.0f} ns" for point, cost in zip(points, costs, strict=True)))


def _curves(quick):
    """Return {what is varied: [(value, Problem, batch, seconds)]}."""
    def some(values):
        return values[1:3] if quick else values

    seconds = 0.25 if quick else 1.0
    small = tube_problem(SMALL_BASIS)
    sized = [tube_problem({**SMALL_BASIS, "basis.free_modes_to_Hz": to}) for to in some(MODES_TO_HZ)]
    # On the free modes alone: a contact point brings no shape of its own, so that the modes stay what they are.
    pointed = [tube_problem({**FREE_MODES, "supports.points": points}) for points in some(POINTS)]
    held = [tube_problem({**FREE_MODES, "supports": plates(small.config, count)}) for count in some(SUPPORTS)]
    return {
        "modes": [(problem.model.modes, problem, BATCH, seconds) for problem in sized],
        "contact points": [(len(problem.model.support_of_point), problem, BATCH, seconds) for problem in pointed],
        "supports": [(len(problem.model.support_names), problem, BATCH, seconds) for problem in held],
        "runs side by side": [(batch, small, batch, seconds) for batch in some(BATCHES)],
        "duration, s": [(duration, small, BATCH, duration) for duration in some(DURATIONS_S)],
    }


def plates(config, count):
    """Return `count` supports as a configuration has them, copies of the first: left leg and right leg in turns, at HEIGHTS_M."""
    first = config.supports[0].model_dump(mode="json")
    legs = (-config.structure.bend_radius_m, config.structure.bend_radius_m)
    return [{**first, "name": f"plate_{number}", "at_m": [legs[number % 2], 0.0, HEIGHTS_M[number // 2]]} for number in range(count)]


def touching(problem):
    """Return the fraction of time that a support bears a force."""
    return contact_fraction(march_ours(problem, problem.force(STATISTICS_S), schedule_of(STATISTICS_S))[0])
