"""The search of a candidate's parameters: stars of runs round the best that was simulated, and what
an emulator of the points near it tells.
"""

from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.integration.contact_convergence import IntegrationError

from .branches import searched_by
from .neighbourhood import NEAR, apart, around, box_round, images, near, nearest, unknown
from .null import free_at
from .path_scores import gains_of, scores_along, scores_of
from .screening import Path, calibrate, simulate_path

# of the searched range: how far to either side a round looks, closer only when the best no longer
# moves
STEPS = (
    0.12,
    0.04,
    0.012,
)
ENOUGH = 2  # this close is close enough where no parameter is known better, and nothing was gained
INSIDE = 0.7  # of a star's radius: an optimum farther out is at its edge, and may lie beyond
ROUNDS = 6  # at most
# of the gain that makes a closer look worth its runs: below it, nothing more is simulated round it
HOPELESS = 0.5
CLEARLY = 5.0  # of log likelihood: less is the scatter of a few seeds
MOVED = 0.06  # of the searched range: farther from where it was told, what is free is told anew
IMAGED = 2  # rounds that try other signs as well
ELSEWHERE = (
    0.5 * NEAR
)  # between where a search ended and what is best by a law of its own: another place


@dataclass(frozen=True)
class Searched:
    """Where stars of runs led: path, of all that was simulated; found: Calibrated; scores (point,)
    of the path; free: null.free_at of `at` (parameter,); losing: whether it was given up.
    """

    path: Path
    found: object
    scores: np.ndarray
    free: np.ndarray
    at: np.ndarray
    losing: bool


def searched(
    bench, null, measured, candidate, path, scales, fit, rounds, least, first_seed, level=0
):
    """Return the Searched of a candidate, its first star one of STEPS[level]; other arguments as of
    finalists.refine.
    """
    centre = path.parameters[np.argmax(scores_of(bench, null, measured, path, fit))]
    at = None
    free = None
    own = null
    gain = gains_of(bench, null, measured, path).max()
    losing = gain < min(least, HOPELESS * least)
    for number in range(rounds):
        looked_at = [
            *around(centre, STEPS[level], candidate.periodic),
            *(images(centre, candidate.signed) if number < IMAGED else []),
        ]
        points = [] if losing else unknown(looked_at, path, candidate.periodic)
        fresh = (
            simulate_path(
                bench, candidate, points, scales, null.records, first_seed=first_seed + 500 * number
            )
            if len(points)
            else None
        )
        known = len(path.parameters)
        path = path if fresh is None else path.joined(fresh)
        before, gain = gain, gains_of(bench, null, measured, path, own).max()
        # rounds to come may bring as much as the last; what began with a star has had none
        losing = losing or (
            fresh is not None and gain + (rounds - 1 - number) * max(0.0, gain - before) < least
        )
        if not losing and (at is None or apart(centre, at, candidate.periodic).max() > MOVED):
            at = path.parameters[nearest(path, centre, candidate.periodic)]
            free = free_of(bench, null, candidate, at, scales, first_seed + 400 + 50 * number)
            gain = gains_of(
                bench,
                null,
                measured,
                path,
                searched_by(null, measured, path, at, candidate.periodic, free),
            ).max()
        own = (
            own if free is None else searched_by(null, measured, path, at, candidate.periodic, free)
        )
        found = _calibrated_near(bench, own, measured, candidate, path, fit)
        scores = scores_along(bench, own, measured, candidate, path, fit)
        better = scores.max() > scores[:known].max() + CLEARLY
        stayed = np.all(apart(found.unit, centre, candidate.periodic) <= INSIDE * STEPS[level])
        if stayed or (number and not better):
            level += 1  # it stayed within what was looked at, or led nowhere: look closer
        centre = (
            found.unit if stayed or better or not number else path.parameters[np.argmax(scores)]
        )
        if (
            losing
            or level == len(STEPS)
            or (
                level >= ENOUGH
                and stayed
                and not better
                and np.ptp(found.interval, axis=1).min() > STEPS[level]
            )
        ):
            break
    return Searched(
        path,
        _with_whole_interval(bench, own, measured, candidate, path, fit, found),
        scores,
        free,
        at,
        losing,
    )


def with_other_signs(bench, null, measured, candidate, looked, scales, fit, least, first_seed):
    """Return the Searched of a candidate, its search gone on where another sign of its best point
    is better: far from the optimum, signs are told from nothing.
    """
    best = looked.path.parameters[np.argmax(looked.scores)]
    points = (
        []
        if looked.losing
        else unknown(images(best, candidate.signed), looked.path, candidate.periodic)
    )
    other = (
        simulate_path(bench, candidate, points, scales, null.records, first_seed=first_seed)
        if len(points)
        else None
    )
    if other is None:
        return looked
    own, path = null.freed(looked.free), looked.path.joined(other)
    scores = scores_along(bench, own, measured, candidate, path, fit)
    if np.argmax(scores) < len(looked.path.parameters):
        return looked
    return searched(
        bench,
        null,
        measured,
        candidate,
        path,
        scales,
        fit,
        len(STEPS),
        least,
        first_seed + 500,
        level=1,
    )


def from_elsewhere(bench, null, measured, candidate, looked, scales, fit, least, first_seed):
    """Return the Searched of a candidate, its search gone on from the point that is best by its own
    law, where that is another place than the one where it ended.

    What two laws may differ by is one for all points that are compared, that of the best of them;
    far from the answer each of several points is best by its own, and the search goes from one to
    the next. By a law of its own each, they lead uphill.
    """
    path, level, periodic = looked.path, 0, candidate.periodic
    scores = scores_of(bench, null, measured, path, fit)
    centre = path.parameters[np.argmax(scores)]
    if looked.losing or apart(centre, looked.found.unit, periodic).max() <= ELSEWHERE:
        return looked
    for number in range(ROUNDS):
        points = unknown(around(centre, STEPS[level], periodic), path, periodic)
        fresh = (
            simulate_path(
                bench, candidate, points, scales, null.records, first_seed=first_seed + 500 * number
            )
            if len(points)
            else None
        )
        path, before = path if fresh is None else path.joined(fresh), scores.max()
        scores = scores_of(bench, null, measured, path, fit)
        centre, better = path.parameters[np.argmax(scores)], scores.max() > before + CLEARLY
        level += not better
        if level == ENOUGH:
            break
        if better:
            centre = calibrate(
                bench,
                null,
                measured,
                candidate,
                path.of(near(path, centre, periodic)),
                fit,
                box_round(centre, periodic),
            ).unit
    return searched(
        bench,
        null,
        measured,
        candidate,
        path,
        scales,
        fit,
        len(STEPS),
        least,
        first_seed + 500 * ROUNDS,
        level=1,
    )


def free_of(bench, null, candidate, unit, scales, first_seed):
    """Return null.free_at of a point, nothing where it can not be simulated."""
    try:
        return free_at(bench, candidate, unit, scales, null.records, first_seed)
    except IntegrationError:
        return np.zeros((0, *null.mean.shape))


def _best_simulated(bench, null, measured, candidate, path, fit):
    """Return (parameter,) the point of a path that comes nearest to what was measured."""
    return path.parameters[np.argmax(scores_along(bench, null, measured, candidate, path, fit))]


def _calibrated_near(bench, null, measured, candidate, path, fit):
    """Return the Calibrated of the points near the best simulated one, looked for near it: what an
    effect changes elsewhere tells little, and where nothing was simulated an emulator forgives what
    it does not know.
    """
    best = _best_simulated(bench, null, measured, candidate, path, fit)
    return calibrate(
        bench,
        null,
        measured,
        candidate,
        path.of(near(path, best, candidate.periodic)),
        fit,
        box_round(best, candidate.periodic),
    )


def _with_whole_interval(bench, null, measured, candidate, path, fit, found):
    """Return the Calibrated with the intervals of the whole path where those of the near points
    reach as far as the points.
    """
    best = _best_simulated(bench, null, measured, candidate, path, fit)
    wide = np.abs(found.interval - best[:, None]).max(axis=1) > NEAR - STEPS[-1]
    if not wide.any():
        return found
    whole = calibrate(bench, null, measured, candidate, path, fit).interval
    lower = np.minimum(found.interval[:, 0], whole[:, 0])
    upper = np.maximum(found.interval[:, 1], whole[:, 1])
    return replace(
        found, interval=np.where(wide[:, None], np.stack([lower, upper], axis=1), found.interval)
    )
