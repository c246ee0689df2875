"""How the project's cost grows: with modes, contact points, supports, runs side by side and
duration.
"""

from dataclasses import dataclass

import numpy as np

from evidence.benchmarks.ours import contact_fraction
from evidence.benchmarks.pairs import our_cost, our_long_cost
from evidence.benchmarks.problem import FREE_MODES, RATE, SMALL_BASIS, tube_problem

MODES_TO_HZ = (500.0, 2000.0, 4000.0, 6000.0, 8000.0)
POINTS = (1, 3, 5, 9)
SUPPORTS = (1, 2, 4, 6)
BATCHES = (1, 2, 4, 8, 16, 32)
DURATIONS_S = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
BATCH = 8
HEIGHTS_M = (0.35, 0.20, 0.50)  # of the plates, on either leg in turns
STATISTICS_S = 0.5


@dataclass(frozen=True)
class Growth:
    """One point of a curve: what is varied, its value, what was run, and the cost (repeat,) in s
    per simulated s and run.
    """

    varied: str
    value: float
    modes: int
    contact_points: int
    supports: int
    batch: int
    duration_s: float
    contact_fraction: float
    cost: list
    clock: str

    @property
    def ns_per_step(self):
        """Return (repeat,) ns per step and run."""
        return 1.0e9 * np.array(self.cost) / RATE


def growth_points(clock, quick=False, say=print):
    """Yield the Growth of every curve. Repeats in turns over the points of a curve, so that a
    machine's moods fall on all of them.
    """
    for varied, cases in _curves(quick).items():
        points = [
            (value, problem, batch, *_measure(problem, batch, seconds, clock))
            for value, problem, batch, seconds in cases
        ]
        costs = [[] for _ in points]
        for _ in range(clock.repeats):
            for cost, (*_, measure, _) in zip(costs, points, strict=True):
                cost.append(measure())
        for cost, (value, problem, batch, _, seconds) in zip(costs, points, strict=True):
            yield growth_of(varied, value, problem, batch, seconds, cost)
        told = [
            f"{point[0]:g}: {1e9 * np.median(cost) / RATE:.0f} ns"
            for point, cost in zip(points, costs, strict=True)
        ]
        say(f"growth with {varied}: {', '.join(told)}")


def _measure(problem, batch, seconds, clock):
    """Return (function () -> cost, simulated s): of `seconds`, or, for None, as long as the clock
    has it.
    """
    if seconds is None:
        return our_long_cost(problem, batch, clock.ours_s)
    cost = our_cost(problem, batch, seconds)
    cost()
    return cost, seconds


def growth_of(varied, value, problem, batch, seconds, cost, clock="CPU"):
    """Return the Growth of a problem at a value of what is varied; the time in contact is that of a
    short run.
    """
    model, touching = problem.model, contact_fraction(problem, STATISTICS_S)
    return Growth(
        varied,
        value,
        model.modes,
        len(model.support_of_point),
        len(model.support_names),
        batch,
        seconds,
        touching,
        cost,
        clock,
    )


def _curves(quick):
    """Return {what is varied: [(value, Problem, batch, simulated s or None)]}."""

    def some(values):
        return values[1:3] if quick else values

    small = tube_problem(SMALL_BASIS)
    sized = [
        tube_problem({**SMALL_BASIS, "basis.free_modes_to_Hz": to}) for to in some(MODES_TO_HZ)
    ]
    # On the free modes alone: a contact point brings no shape of its own, so that the modes stay
    # what they are.
    pointed = [tube_problem({**FREE_MODES, "supports.points": points}) for points in some(POINTS)]
    held = [
        tube_problem({**FREE_MODES, "supports": plates(small.config, count)})
        for count in some(SUPPORTS)
    ]
    return {
        "modes": [(problem.model.modes, problem, BATCH, None) for problem in sized],
        "contact points": [
            (len(problem.model.support_of_point), problem, BATCH, None) for problem in pointed
        ],
        "supports": [(len(problem.model.support_names), problem, BATCH, None) for problem in held],
        "runs side by side": [(batch, small, batch, None) for batch in some(BATCHES)],
        "duration, s": [(duration, small, BATCH, duration) for duration in some(DURATIONS_S)],
    }


def plates(config, count):
    """Return `count` supports as a configuration has them, copies of the first: left leg and right
    leg in turns, at HEIGHTS_M.
    """
    first = config.supports[0].model_dump(mode="json")
    legs = (-config.structure.bend_radius_m, config.structure.bend_radius_m)
    return [
        {
            **first,
            "name": f"plate_{number}",
            "at_m": [legs[number % 2], 0.0, HEIGHTS_M[number // 2]],
        }
        for number in range(count)
    ]
