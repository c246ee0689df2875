"""Gauss-Newton steps of what leads: from its best run down to where least is left."""

import numpy as np
from scipy.optimize import lsq_linear

from .search import Search

ROUNDS = 8
STEP = (0.01, 0.05)  # of the searched range: the least and largest difference
CHANGED = 0.5  # of what is left, as an amplitude, by a difference
FARTHEST = 0.2  # of the searched range: a step
SHORTER = 3  # steps that are tried, each half as long as the one before
NEGLIGIBLE = 0.05  # of what is left beyond chance: less is not worth another round


def descend(search: Search, name: str) -> None:
    """Run an explanation at its best run's neighbours, one along each parameter, and where the
    line through them leaves least (Nocedal and Wright 2006, section 10.3), as long as less is
    left; steps that leave more are shortened.

    Few even or random points find a valley, and seldom the place in it where least is left.
    """
    trial, difference, farthest = search.trials[name], STEP[1], FARTHEST
    for _ in range(ROUNDS):
        unit, change, before = best_run(search, name)
        if before <= search.null.values:
            return
        steps = np.where(unit < 0.5, difference, -difference)
        known = len(trial.noise)
        search.run([(name, unit + np.diag(steps))])
        if len(trial.noise) < known + unit.size:
            return  # one of them could not be run, or the search is over
        slope = (trial.change[-unit.size :] - change).T / steps
        for _ in range(SHORTER):
            low, high = np.maximum(-farthest, -unit), np.minimum(farthest, 1.0 - unit)
            # no bounds may be equal
            bounds = low, np.maximum(high, low + 1.0e-6)
            step = lsq_linear(slope, search.null.measured - change, bounds).x
            search.run([(name, (unit + step)[None])])
            after = best_run(search, name)[2]
            if after < before:
                break
            farthest = 0.5 * float(np.abs(step).max())
        if before - after < NEGLIGIBLE * (before - search.null.values):
            return
        size = np.maximum(np.linalg.norm(slope, axis=0), 1.0e-12)
        difference = np.clip(CHANGED * np.sqrt(after) / size, *STEP)
        farthest = min(2.0 * farthest, FARTHEST)


def best_run(search: Search, name: str) -> tuple[np.ndarray, np.ndarray, float]:
    """Return (unit, change, chi-square that is left) of the run of an explanation that leaves
    least.
    """
    trial = search.trials[name]
    left = np.sum((search.null.measured - trial.change) ** 2, axis=1)
    best = int(np.argmin(left))
    return trial.unit[best], trial.change[best], float(left[best])
