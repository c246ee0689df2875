"""Calibrating a candidate: simulate it at a few parameters, emulate between them, find the most probable ones, simulate there, again."""

from dataclasses import dataclass

import numpy as np

from vibroimpact.discrepancy import nuisance as linear
from vibroimpact.discrepancy.emulator import Emulator
from vibroimpact.discrepancy.features import compressed
from vibroimpact.discrepancy.likelihood import log_likelihood

GRID = 41  # points per parameter on which the emulator is searched


@dataclass
class Path:
    """What was simulated of a candidate: parameters (point, parameter) normalised; features (point, record, feature) means over seeds; seeds of
    each; readings: list of the low-level Reading or None where it is the bare model's."""

    parameters: np.ndarray
    features: np.ndarray
    seeds: np.ndarray
    readings: list

    def joined(self, other):
        """Return both paths as one."""
        return Path(np.vstack([self.parameters, other.parameters]), np.concatenate([self.features, other.features]),
                    np.concatenate([self.seeds, other.seeds]), self.readings + other.readings)  # fmt: skip


def simulate_path(bench, candidate, parameters, scales, records, seeds=None, first_seed=100):
    """Return the Path of a candidate at normalised parameters (point, parameter)."""
    seeds = bench.seeds_of_a_batch([*records, bench.signals.lowest]) if seeds is None else seeds
    means, readings = [], []
    for number, unit in enumerate(np.atleast_2d(parameters)):
        physical = candidate.physical(unit, scales)
        values = candidate.variant(bench.values, physical)
        runs = bench.runs(records, seeds, first_seed + 50 * number)
        low = bench.linear_stage and not candidate.effect.linear
        model = bench.model(values)
        responses = bench.respond(model, runs + bench.runs([bench.signals.lowest], 1) * low, candidate.measuring(physical, bench.signals.names))
        means.append(bench.noisy_features(runs, responses[: len(runs)]).reshape(len(records), seeds, -1).mean(axis=1))
        readings.append(bench.low_reading(responses[-1] / bench.gains[:, None]) if low else None)
        if candidate.effect.linear and not candidate.effect.measured and bench.linear_stage:
            readings[-1] = bench.linear_reading(values, bench.measured_fit.modes)
    return Path(np.atleast_2d(parameters), np.array(means), np.full(len(means), seeds), readings)


def linear_score(bench, reading):
    """Return the log likelihood of the lowest record's Reading under a variant's; of the bare model where it is None."""
    if not bench.linear_stage:
        return 0.0
    fit = bench.measured_fit
    simulated = linear.reading_of_model(bench.bare, fit.modes) if reading is None else reading
    return linear.likelihood(bench.measured_reading, simulated, fit.covariance)[0]


def record_scores(bench, null, measured, mean, seeds, changed):
    """Return (record,) log likelihood of measured features (record, feature) under means (record, feature)."""
    out = []
    for record in range(len(measured)):
        change = compressed(mean[record] - null.scatter[record].mean) if changed else None
        out.append(log_likelihood(measured[record], mean[record], null.scatter[record], null.base_sd, seeds, change)[0])
    return np.array(out)


def null_scores(bench, null, measured):
    """Return (record,) log likelihood of the measurement under the null."""
    return record_scores(bench, null, measured, np.array([scatter.mean for scatter in null.scatter]), null.features.shape[1], False)


def emulated(null, path, periodic):
    """Return the Emulator of a path's features beyond the null's, compressed, all records one after another."""
    reference = np.array([scatter.mean for scatter in null.scatter])
    deviations = compressed(path.features - reference).reshape(len(path.features), -1)
    return Emulator(path.parameters, deviations, periodic)


def uncompressed(values):
    """The inverse of features.compressed."""
    from vibroimpact.discrepancy.features import BLEND_DB

    return BLEND_DB * np.sinh(values / BLEND_DB)


def best_of(bench, null, measured, candidate, path, fit_records, weights=None):
    """Return (normalised parameters (parameter,), fit score): the most probable ones on the fit records by the emulator."""
    emulator = emulated(null, path, candidate.periodic)
    reference = np.array([scatter.mean for scatter in null.scatter])
    lows = np.array([linear_score(bench, reading) for reading in path.readings])
    low_emulator = Emulator(path.parameters, lows[:, None], candidate.periodic) if np.ptp(lows) > 0.0 else None
    whitened = _Whitened(null, measured, reference, fit_records, int(np.median(path.seeds)))
    count = path.parameters.shape[1]
    axis = np.linspace(0.0, 1.0, GRID if count == 1 else 21)
    grid = np.stack([axes.ravel() for axes in np.meshgrid(*[axis] * count, indexing="ij")], axis=-1)
    scores = np.array([_score(unit, emulator, low_emulator, whitened) for unit in grid])
    best = grid[np.argmax(scores)]
    return best, float(scores.max()), grid, scores


def _score(unit, emulator, low_emulator, whitened):
    deviation, unknown = emulator(unit)
    low = 0.0 if low_emulator is None else float(low_emulator(unit)[0][0])
    return whitened(deviation) + low - 2.0 * unknown * 10.0


class _Whitened:
    """Fast log likelihood of deviations from the null on some records: the null covariance factored once, the law error left out."""

    def __init__(self, null, measured, reference, records, seeds):
        from scipy import linalg

        self.records, self.shape = records, reference.shape
        self.targets, self.factors = [], []
        for record in records:
            covariance = null.scatter[record].covariance * (1.0 + 1.0 / seeds) + np.diag(null.base_sd**2)
            factor = linalg.cholesky(covariance, lower=True)
            self.factors.append(linalg.solve_triangular(factor, np.eye(len(factor)), lower=True))
            self.targets.append(self.factors[-1] @ compressed(measured[record] - reference[record]))

    def __call__(self, deviation):
        deviation = deviation.reshape(self.shape)
        total = 0.0
        for record, factor, target in zip(self.records, self.factors, self.targets, strict=True):
            total -= 0.5 * np.sum((target - factor @ deviation[record]) ** 2)
        return total
