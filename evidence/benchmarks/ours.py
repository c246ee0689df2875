"""The project itself, through its public path: cases in, displacement records, statistics and
energies out.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from evidence.benchmarks.problem import RATE, SENSORS, STRIDE
from vibroimpact.integration.batch import ENERGY_TERMS, Schedule, integrate_batch

SAMPLING_HZ = RATE // STRIDE


@dataclass(frozen=True)
class Step:
    """A scheme of integration and its steps per second."""

    scheme: str
    rate: int


SAME_STEP = Step("newmark", RATE)  # as the peers that do the same step


def study_step(problem):
    """Return the Step of the problem's configuration."""
    return Step(problem.config.integration.scheme, problem.config.integration.steps_per_second)


def schedule_of(seconds, step=SAME_STEP):
    """Return the Schedule of a record of `seconds` without start-up."""
    return Schedule(step.rate, SAMPLING_HZ, 0.0, seconds, step.scheme)


def march_ours(problem, forces, schedule, touching=True):
    """Return [BatchResult]: the runs of forces (step + 1, case) N, index k at step k, in as many
    batches as the library asks for.

    A force that ends before the schedule's last step goes on as zero.
    """
    forces = np.atleast_2d(np.asarray(forces).T).T
    cases = forces.shape[1]
    # The library's force begins one step before time 0.
    padded = np.zeros((max(schedule.steps + 2, len(forces) + 1), cases))
    padded[1 : len(forces) + 1] = forces
    width = batch_width(cases)
    return [
        _march(problem, padded[:, first : first + width], schedule, touching)
        for first in range(0, cases, width)
    ]


def displacement(problem, forces, seconds, touching=True):
    """Return (sample, sensor) m of the first case at the SENSORS, samples every STRIDE steps from
    time 0 on.
    """
    lanes = march_ours(problem, forces, schedule_of(seconds), touching)[0]
    return lanes.displacement[
        0, [problem.model.sensor_names.index(name) for name in SENSORS]
    ].T.astype(float)


def contact_fraction(problem, seconds):
    """Return the fraction of the first `seconds` in which a support bears a force, mean over
    supports.
    """
    schedule = schedule_of(seconds)
    # Statistics begin when the output filter is full: the force waits for it.
    waiting = schedule.steps - schedule.samples * STRIDE
    lanes = march_ours(
        problem, np.concatenate([np.zeros(max(waiting, 0)), problem.force(seconds)]), schedule
    )[0]
    return float(np.mean(lanes.tally["contact_steps"]) / lanes.steps)


def last_energies(lanes):
    """Return {term: (case,) J} at the end of the last step."""
    return {name: lanes.energy[:, index, -1] for index, name in enumerate(ENERGY_TERMS)}


def _march(problem, forces, schedule, touching):
    cases = forces.shape[1]
    offset = np.repeat(problem.offset[:, :, None], cases, axis=2)
    gap = np.full(cases, problem.contact_gap(touching))
    return integrate_batch(
        problem.model,
        schedule,
        gap,
        offset,
        lambda first, count: forces[first : first + count, None, :],
    )


@cache
def batch_width(cases):
    """Return how many of `cases` the library takes in one call: all, or a half, a quarter, ... of
    them.
    """
    from vibroimpact.integration.kernels.lanes import LANES

    return cases if cases <= LANES else batch_width(-(-cases // 2))
