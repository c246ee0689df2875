"""Calibrating a candidate: simulate it at a few parameters, emulate between them, find the most probable ones, simulate there, again."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RBFInterpolator

from vibroimpact.contraction import IntegrationError
from vibroimpact.discrepancy import nuisance as linear
from vibroimpact.discrepancy.emulator import Emulator
from vibroimpact.discrepancy.features import compressed, uncompressed
from vibroimpact.discrepancy.likelihood import log_likelihood

LEAST_LOW = 300.0  # log likelihood of the lowest record below the best: farther off tells nothing more
SMOOTHING = 1.0e-3  # points that were simulated twice differ by the seeds
SWEEPS, SCAN = 3, 21  # of a coordinate search, where a grid over all parameters would be too large
GRID = {1: 61, 2: 21}  # points per parameter on which the emulator is searched, by the number of parameters


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
    kept, means, readings = [], [], []
    for number, unit in enumerate(np.atleast_2d(parameters)):
        physical = candidate.physical(unit, scales)
        values = candidate.variant(bench.values, physical)
        runs = bench.runs(records, seeds, first_seed + 50 * number)
        low = bench.linear_stage and not candidate.effect.measured
        try:
            model = bench.model(values)
            responses = bench.respond(model, runs + bench.runs([bench.signals.lowest], 1) * low, candidate.measuring(physical, bench.signals.names))
        except IntegrationError:
            continue  # an effect this strong throws the structure off: no measurement comes from there
        kept.append(unit)
        means.append(bench.noisy_features(runs, responses[: len(runs)]).reshape(len(records), seeds, -1).mean(axis=1))
        readings.append(bench.low_reading(responses[-1] / bench.gains[:, None]) if low else None)
    return Path(np.array(kept), np.array(means), np.full(len(means), seeds), readings) if kept else None


def linear_score(bench, reading):
    """Return the log likelihood of the lowest record's Reading under a variant's; of the bare model where it is None."""
    if not bench.linear_stage:
        return 0.0
    fit = bench.measured_fit
    simulated = linear.reading_of_model(bench.bare, fit.modes) if reading is None else reading
    return linear.likelihood(bench.measured_reading, simulated, fit.covariance)[0]


def null_scores(bench, null, measured):
    """Return (record,) log likelihood of measured features (record, feature) under the null."""
    residual = compressed(measured - null.mean, bench.layout)
    return np.array([log_likelihood(*row)[0] for row in zip(residual, null.covariance, strict=True)])


def direct_scores(bench, null, measured, mean):
    """Return (record,) log likelihood of measured features (record, feature) under simulated means (record, feature)."""
    residual, change = compressed(measured - mean, bench.layout), compressed(mean - null.mean, bench.layout)
    return np.array([log_likelihood(residual[record], null.covariance[record], change[record], null.groups)[0] for record in range(len(measured))])


def path_emulator(bench, null, path, candidate):
    """Return the Emulator of what a path changes of the null's features, compressed, all records one after another."""
    deviations = compressed(path.features - null.mean, bench.layout).reshape(len(path.features), -1)
    noise = null.seed_variance.mean() / path.seeds / max(deviations.var(axis=0).mean(), 1.0e-6)
    return Emulator(path.parameters, deviations, np.minimum(noise, 1.0), candidate.periodic)


@dataclass(frozen=True)
class Calibrated:
    """The most probable parameters by emulation: unit (parameter,) normalised; scores (record,) log likelihoods there; low: that of the lowest record;
    mean (record, feature); interval (parameter, 2) of 90 %; profile: [(values (n,), score (n,))] along each parameter."""

    unit: np.ndarray
    scores: np.ndarray
    low: float
    mean: np.ndarray
    interval: np.ndarray
    profile: list


def calibrate(bench, null, measured, candidate, path, fit):
    """Return the Calibrated of a candidate's path; fit (record,) bool: the records that the parameters are fitted to, beside the lowest one."""
    emulator = path_emulator(bench, null, path, candidate)
    low_scores = np.array([linear_score(bench, reading) for reading in path.readings])
    low_at = _lows(path.parameters, np.maximum(low_scores, low_scores.max() - LEAST_LOW))
    spread = emulator.deviations.var(axis=0).reshape(null.mean.shape)

    def at(unit, records):
        deviation, unknown = emulator(unit)
        deviation = deviation.reshape(null.mean.shape)
        residual = compressed(measured - null.mean - uncompressed(deviation, bench.layout), bench.layout)
        scores = np.array([log_likelihood(residual[record], null.covariance[record], deviation[record], null.groups, unknown * spread[record])[0]
                           for record in records])  # fmt: skip
        return scores, deviation

    def fit_score(unit):
        return at(unit, np.flatnonzero(fit))[0].sum() + low_at(unit)

    start = path.parameters[np.argmax([fit_score(unit) for unit in path.parameters])]
    unit, profile = (_grid if path.parameters.shape[1] in GRID else _scan)(fit_score, start)
    records, deviation = at(unit, np.arange(len(measured)))
    interval = np.array([_above(values, score) for values, score in profile])
    return Calibrated(unit, records, low_at(unit), null.mean + uncompressed(deviation, bench.layout), interval, profile)


def _grid(score, start):
    """Return (unit, profile) of the best of a grid over all parameters."""
    count = len(start)
    axis = np.linspace(0.0, 1.0, GRID[count])
    grid = np.stack([axes.ravel() for axes in np.meshgrid(*[axis] * count, indexing="ij")], axis=-1)
    scores = np.array([score(unit) for unit in grid])
    unit, scores = grid[np.argmax(scores)], scores.reshape([len(axis)] * count)
    return unit, [(axis, np.moveaxis(scores, number, 0).reshape(len(axis), -1).max(axis=1)) for number in range(count)]


def _scan(score, start):
    """Return (unit, profile) of a search along one parameter after the other."""
    unit, axis = np.array(start), np.linspace(0.0, 1.0, SCAN)
    for _ in range(SWEEPS):
        profile = []
        for number in range(len(unit)):
            along = np.repeat(unit[None], SCAN, axis=0)
            along[:, number] = axis
            scores = np.array([score(point) for point in along])
            unit = along[np.argmax(scores)]
            profile.append((axis, scores))
    return unit, profile


def _lows(parameters, scores):
    """Return the function unit -> log likelihood of the lowest record, between the simulated parameters (point, parameter)."""
    if np.ptp(scores) == 0.0 or len(scores) <= parameters.shape[1] + 1:
        return lambda unit: float(scores[np.argmin(np.sum((parameters - unit) ** 2, axis=1))])
    interpolator = RBFInterpolator(parameters, scores, kernel="linear", degree=0, smoothing=SMOOTHING)
    return lambda unit: float(interpolator(np.atleast_2d(unit))[0])


def _above(values, score, drop=1.353):
    """Return (low, high) of the values whose score is within `drop` of the best (90 % of a normal law), between grid points by parabola and line."""
    best = int(np.argmax(score))
    ends = []
    for step in (-1, 1):
        place = best
        while 0 <= place + step < len(values) and score[place + step] > score[best] - drop:
            place += step
        if not 0 <= place + step < len(values):
            ends.append(values[place])
            continue
        fall = score[place] - score[place + step]
        share = (score[place] - (score[best] - drop)) / fall if fall > 0.0 else 1.0
        share = np.sqrt(share) if place == best else share  # beside a peak the score falls with the square
        ends.append(values[place] + step * share * (values[1] - values[0]))
    return np.clip(ends, 0.0, 1.0)
