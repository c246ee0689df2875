"""Finalists: candidates refined where emulation puts them, each round with more seeds, and judged by what is simulated there and nothing else."""

from dataclasses import dataclass

import numpy as np

from vibroimpact.discrepancy import priors
from vibroimpact.discrepancy.screening import Path, calibrate, direct_scores, linear_score, simulate_path

STEPS = (0.08, 0.03)  # of the searched range: how far to either side a round looks
ROUND_SEEDS = 2
START_STEP = 0.12


@dataclass(frozen=True)
class Finalist:
    """A candidate after direct simulation: unit (parameter,) normalised; interval (parameter, 2); scores (record,) and low: log likelihoods by direct
    simulation; mean (record, feature) over `features` (record, seed, feature); path: all that was simulated; profile: see screening.Calibrated."""

    candidate: object
    unit: np.ndarray
    interval: np.ndarray
    scores: np.ndarray
    low: float
    features: np.ndarray
    path: Path
    profile: list

    @property
    def mean(self):
        """Return (record, feature) the mean over seeds."""
        return self.features.mean(axis=1)


def started(bench, null, candidate, unit, scales, first_seed=2000):
    """Return the Path round normalised parameters of a candidate that was not screened: a pair, or an effect at another place."""
    return simulate_path(bench, candidate, _around(unit, START_STEP, candidate.periodic), scales, null.records, ROUND_SEEDS, first_seed)


def refine(bench, null, measured, candidate, path, scales, fit, rounds=len(STEPS), seeds=priors.FINAL_SEEDS, first_seed=3000):
    """Return the Finalist of a candidate whose Path has been screened; fit (record,) bool: the records its parameters are fitted to."""
    for number, step in enumerate(STEPS[:rounds]):
        unit = calibrate(bench, null, measured, candidate, path, fit).unit
        fresh = simulate_path(bench, candidate, _around(unit, step, candidate.periodic), scales, null.records, ROUND_SEEDS, first_seed + 500 * number)
        path = path if fresh is None else path.joined(fresh)
    found = calibrate(bench, null, measured, candidate, path, fit)
    return judged(bench, null, measured, candidate, found.unit, path, found, scales, seeds, first_seed + 5000)


def judged(bench, null, measured, candidate, unit, path, found, scales, seeds, first_seed):
    """Return the Finalist at normalised parameters (parameter,), by `seeds` runs of every record."""
    physical = candidate.physical(unit, scales)
    model = bench.model(candidate.variant(bench.values, physical))
    runs = bench.runs(null.records, seeds, first_seed)
    features = bench.features(model, runs, candidate.measuring(physical, bench.signals.names)).reshape(len(null.records), seeds, -1)
    scores = direct_scores(bench, null, measured, features.mean(axis=1))
    nearest = int(np.argmin(np.sum((path.parameters - unit) ** 2, axis=1)))
    return Finalist(candidate, unit, found.interval, scores, linear_score(bench, path.readings[nearest]), features, path, found.profile)


def _around(unit, step, periodic):
    """Return (point, parameter): unit and its neighbours along each parameter, within 0 to 1 (an angle wraps round)."""
    points = [unit]
    for number in range(len(unit)):
        for side in (-step, step):
            moved = np.array(unit)
            moved[number] = (moved[number] + side) % 1.0 if number in periodic else np.clip(moved[number] + side, 0.0, 1.0)
            if not np.allclose(moved, unit):
                points.append(moved)
    return np.array(points)
