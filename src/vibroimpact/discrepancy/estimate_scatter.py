"""How far an estimate scatters by itself: the seeds of the completed model, each in turn in the place of the measurement (a parametric bootstrap)."""

from dataclasses import replace

import numpy as np

from vibroimpact.discrepancy import priors
from vibroimpact.discrepancy.finalists import near, offset, scores_along
from vibroimpact.discrepancy.naming import fit_mask
from vibroimpact.discrepancy.screening import calibrate

EXCLUDED = 50.0  # of log likelihood: more than the scatter of two seeds


def with_scatter(bench, null, measured, found):
    """Return a Finalist whose intervals hold, beside what the likelihood tells, how far its estimates from its own seeds lie from the truth there.

    The likelihood takes the mean that a few runs give for the law itself; where motion breaks out in one run and not in another, that is too sure.
    Source: B. Efron, R. Tibshirani, An Introduction to the Bootstrap (1993), section 6.5.
    """
    candidate, own, path, fit = found.candidate, found.own(null), found.path, fit_mask(bench, null)
    known = path.of(near(path, found.unit, candidate.periodic))
    moved = [offset(calibrate(bench, own, found.features[:, seed], candidate, known, fit).unit, found.unit, candidate.periodic)
             for seed in range(found.features.shape[1])]  # fmt: skip
    scatter = priors.NINETY_SD * np.sqrt(np.mean(np.square(moved), axis=0))
    below, above = (np.hypot(side * (found.interval[:, end] - found.unit), scatter) for end, side in ((0, -1.0), (1, 1.0)))
    interval = np.clip(np.stack([found.unit - below, found.unit + above], axis=1), 0.0, 1.0)
    single = len(interval) == 1 and not candidate.periodic
    return replace(found, interval=_within_simulated(path, scores_along(bench, own, measured, candidate, path, fit), found.unit, interval) if single else interval)


def _within_simulated(path, scores, unit, interval):
    """Return the interval (1, 2) of a single parameter no wider than to where what was simulated, of scores (point,), is clearly worse: an emulator forgives
    what it does not know."""
    points = path.parameters[:, 0]
    worse = points[scores < scores.max() - EXCLUDED]
    return np.clip(interval, worse[worse < unit[0]].max(initial=0.0), worse[worse > unit[0]].min(initial=1.0))
