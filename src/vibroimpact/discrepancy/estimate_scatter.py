"""How far an estimate scatters by itself: the seeds of the completed model, each in turn in the
place of the measurement (a parametric bootstrap).
"""

from dataclasses import replace

import numpy as np

from . import priors
from .naming import fit_mask
from .neighbourhood import box_round, near, offset
from .path_scores import scores_along
from .screening import calibrate

EXCLUDED = (
    80.0  # of log likelihood: more than the scatter of two seeds, by which neighbours differ by 50
)


def with_scatter(bench, null, measured, found):
    """Return a Finalist whose intervals hold, beside what the likelihood tells, how far its
    estimates from its own seeds lie from the truth there.

    The likelihood takes the mean that a few runs give for the law itself; where motion breaks out
    in one run and not in another, that is too sure. Source: B. Efron, R. Tibshirani, An
    Introduction to the Bootstrap (1993), section 6.5.
    """
    candidate, own, path, fit = found.candidate, found.own(null), found.path, fit_mask(bench, null)
    known = path.of(near(path, found.unit, candidate.periodic))
    box = box_round(found.unit, candidate.periodic)
    moved = [
        offset(
            calibrate(bench, own, found.features[:, seed], candidate, known, fit, box).unit,
            found.unit,
            candidate.periodic,
        )
        for seed in range(found.features.shape[1])
    ]
    scatter = priors.NINETY_SD * np.sqrt(np.mean(np.square(moved), axis=0))
    below, above = (
        np.hypot(side * (found.interval[:, end] - found.unit), scatter)
        for end, side in ((0, -1.0), (1, 1.0))
    )
    interval = np.clip(np.stack([found.unit - below, found.unit + above], axis=1), 0.0, 1.0)
    return replace(
        found,
        interval=_as_simulated(
            path,
            scores_along(bench, own, measured, candidate, path, fit),
            found.unit,
            interval,
            candidate.periodic,
        ),
    )


def _as_simulated(path, scores, unit, interval, periodic):
    """Return the interval (parameter, 2) with what was simulated, of scores (point,), and is not
    clearly worse; that of a single parameter no wider than to where it is: an emulator forgives
    what it does not know.
    """
    worse = scores < scores.max() - EXCLUDED
    if len(unit) == 1 and not periodic:
        points = path.parameters[:, 0]
        low = points[worse & (points < unit[0])].max(initial=0.0)
        high = points[worse & (points > unit[0])].min(initial=1.0)
        interval, worse = np.clip(interval, low, high), worse | (points < low) | (points > high)
    if worse.all():  # the best of what was simulated lies beyond a worse point: it bounds nothing
        return interval
    reach = unit + np.array([offset(point, unit, periodic) for point in path.parameters[~worse]])
    return np.clip(
        np.stack(
            [
                np.minimum(interval[:, 0], reach.min(axis=0)),
                np.maximum(interval[:, 1], reach.max(axis=0)),
            ],
            axis=1,
        ),
        0.0,
        1.0,
    )
