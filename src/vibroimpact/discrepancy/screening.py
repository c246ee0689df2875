"""Calibrating a candidate: simulate it at a few parameters, emulate between them, find the most
probable ones, simulate there, again.
"""

from dataclasses import dataclass

import numpy as np
from scipy import optimize
from scipy.interpolate import RBFInterpolator

from vibroimpact.config.reading import ConfigError
from vibroimpact.integration.contact_convergence import IntegrationError

from . import nuisance as linear
from . import priors
from .candidates import unit_grid
from .emulator import Emulator
from .features import compressed, uncompressed
from .likelihood import LawLikelihood, log_likelihood
from .survivors import of_survivors

LEAST_LOW = (
    300.0  # log likelihood of the lowest record below the best: farther off tells nothing more
)
SMOOTHING = 1.0e-3  # points that were simulated twice differ by the seeds
LAW_TURNS = 2  # until the law of the best is that of the best
GRID = {
    1: 41,
    2: 13,
}  # points per parameter on which the emulator is searched first, by the number of parameters
SCAN = 21  # points along one parameter, where a grid over all would be too large
FINEST = 0.004  # of the searched range
NINETY = 1.353  # of log likelihood below the best: the interval of 90 % of a normal law
SCATTER = 2.0  # of an emulated log likelihood, since its means are of few seeds
CURVED = 0.02  # of the searched range: the step of the curvature at the best
WIDEST = 0.5  # of the searched range: no parameter is known worse


@dataclass
class Path:
    """What was simulated of a candidate: parameters (point, parameter) normalised; features (point,
    record, feature) means over seeds; seeds of each; readings: list of the low-level Reading or
    None where it is the bare model's; differences (point, record, feature): of the first two seeds,
    0 where there is one.
    """

    parameters: np.ndarray
    features: np.ndarray
    seeds: np.ndarray
    readings: list
    differences: np.ndarray | None = None

    def __post_init__(self):
        if self.differences is None:
            self.differences = np.zeros_like(self.features)

    def of(self, chosen):
        """Return the path of the points chosen (point,) bool."""
        readings = [row for row, kept in zip(self.readings, chosen, strict=True) if kept]
        return Path(
            self.parameters[chosen],
            self.features[chosen],
            self.seeds[chosen],
            readings,
            self.differences[chosen],
        )

    def joined(self, other):
        """Return both paths as one."""
        return Path(
            np.vstack([self.parameters, other.parameters]),
            np.concatenate([self.features, other.features]),
            np.concatenate([self.seeds, other.seeds]),
            self.readings + other.readings,
            np.concatenate([self.differences, other.differences]),
        )


def simulate_path(bench, candidate, parameters, scales, records, seeds=None, first_seed=100):
    """Return the Path of a candidate at normalised parameters (point, parameter)."""
    lowest, records = bench.signals.lowest, list(records)
    seeds = bench.seeds_of_a_batch({*records, lowest}) if seeds is None else seeds
    kept, means, counts, readings, differences = [], [], [], [], []
    for number, unit in enumerate(np.atleast_2d(parameters)):
        physical = candidate.physical(unit, scales)
        values = bench.variant(candidate, physical)
        runs = bench.runs(records, seeds, first_seed + 50 * number)
        low = bench.reads_lowest and not candidate.effect.measured
        try:
            model = bench.model(values)
            more = bench.runs([lowest], 1) if low and lowest not in records else []
            responses = bench.respond(
                model, runs + more, candidate.measuring(physical, bench.signals.names)
            )
            features = of_survivors(
                bench.noisy_features(runs, responses[: len(runs)]).reshape(len(records), seeds, -1)
            )
        except (IntegrationError, ConfigError):
            # an effect this strong throws the structure off, or is none that a model may have: no
            # measurement comes from there
            continue
        low_response = responses[-1 if lowest not in records else seeds * records.index(lowest)]
        if low and np.isnan(low_response).any():
            continue
        kept.append(unit)
        means.append(features.mean(axis=1))
        differences.append(features[:, 0] - features[:, min(1, features.shape[1] - 1)])
        counts.append(features.shape[1])
        readings.append(bench.low_reading(low_response / bench.gains[:, None]) if low else None)
    return (
        Path(np.array(kept), np.array(means), np.array(counts), readings, np.array(differences))
        if kept
        else None
    )


def linear_score(bench, reading):
    """Return the log likelihood of the lowest record's Reading under a variant's, of the bare model
    where it is None: by a t law, as for other records.
    """
    if not bench.reads_lowest:
        return 0.0
    fit = bench.measured_fit
    score, chi_square, _ = linear.likelihood(
        bench.measured_reading, bench.bare_reading if reading is None else reading, fit.covariance
    )
    size = 2 * len(fit.modes) + fit.participation.size
    return (
        score + 0.5 * chi_square - 0.5 * (priors.TAIL + size) * np.log1p(chi_square / priors.TAIL)
    )


def null_scores(bench, null, measured):
    """Return (record,) log likelihood of measured features (record, feature) under the null."""
    residual = compressed(measured - null.mean, bench.layout)
    return np.array(
        [log_likelihood(*row)[0] for row in zip(residual, null.covariance, strict=True)]
    )


def direct_scores(bench, null, measured, mean, law=None):
    """Return (record,) log likelihood of measured features (record, feature) under simulated means
    (record, feature).

    law (record, compressed feature): the change of which two laws may differ by a share; that of
    the means themselves where None.
    """
    residual = compressed(measured - mean, bench.layout)
    change = compressed(mean - null.mean, bench.layout) if law is None else law
    return np.array(
        [
            log_likelihood(residual[record], null.covariance[record], change[record], null.groups)[
                0
            ]
            for record in range(len(measured))
        ]
    )


def path_emulator(bench, null, path, candidate):
    """Return the Emulator of what a path changes of the null's features, compressed, all records
    one after another.
    """
    deviations = compressed(path.features - null.mean, bench.layout).reshape(len(path.features), -1)
    noise = null.seed_variance.mean() / path.seeds / max(deviations.var(axis=0).mean(), 1.0e-6)
    return Emulator(path.parameters, deviations, np.minimum(noise, 1.0), candidate.periodic)


@dataclass(frozen=True)
class Calibrated:
    """The most probable parameters by emulation: unit (parameter,) normalised; scores (record,) log
    likelihoods there; low: that of the lowest record; mean (record, feature); interval (parameter,
    2) of 90 %; profile: [(values (n,), score (n,))] along each parameter.
    """

    unit: np.ndarray
    scores: np.ndarray
    low: float
    mean: np.ndarray
    interval: np.ndarray
    profile: list


def calibrate(bench, null, measured, candidate, path, fit, box=None):
    """Return the Calibrated of a candidate's path.

    fit (record,) bool: the records that the parameters are fitted to, beside the lowest one; box
    (parameter, 2): where they are looked for, everywhere where it is None.
    """
    emulator = path_emulator(bench, null, path, candidate)
    low_scores = np.array([linear_score(bench, reading) for reading in path.readings])
    low_at = _lows(path.parameters, np.maximum(low_scores, low_scores.max() - LEAST_LOW))
    spread = emulator.deviations.var(axis=0).reshape(null.mean.shape)

    def at(unit, records, likelihoods=None):
        deviation, unknown = emulator(unit)
        deviation = deviation.reshape(null.mean.shape)
        residual = compressed(
            measured - null.mean - uncompressed(deviation, bench.layout), bench.layout
        )
        if likelihoods is not None:
            return (
                np.array([likelihoods[record](residual[record], unknown) for record in records]),
                deviation,
            )
        scores = np.array(
            [
                log_likelihood(
                    residual[record],
                    null.covariance[record],
                    deviation[record],
                    null.groups,
                    unknown * spread[record],
                )[0]
                for record in records
            ]
        )
        return scores, deviation

    fitted = np.flatnonzero(fit)

    def fit_score(unit, likelihoods=None):
        return at(unit, fitted, likelihoods)[0].sum() + low_at(unit)

    unit = path.parameters[np.argmax([fit_score(unit) for unit in path.parameters])]
    # what two laws may differ by grows with the effect: held at its best while the parameters are
    # estimated, or more would always be forgiven
    for _ in range(LAW_TURNS):
        law = at(unit, [])[1]
        held = {
            record: LawLikelihood(null.covariance[record], law[record], null.groups, spread[record])
            for record in fitted
        }
        unit = _best(lambda point, held=held: fit_score(point, held), unit, box)
    profile = _profile(lambda point: fit_score(point, held), unit, box)
    records, deviation = at(unit, np.arange(len(measured)))
    interval = np.array(
        [_above(values, score, at) for at, (values, score) in zip(unit, profile, strict=True)]
    )
    return Calibrated(
        unit,
        records,
        low_at(unit),
        null.mean + uncompressed(deviation, bench.layout),
        interval,
        profile,
    )


def _best(score, start, box=None):
    """Return unit (parameter,) of the best in a box (parameter, 2): the top of a grid over all
    parameters, or of lines through `start` where a grid would be too large, then uphill.
    """
    count = len(start)
    low, high = np.tile([[0.0], [1.0]], count) if box is None else np.transpose(box)
    best = np.clip(start, low, high)
    if count in GRID:
        best = _top(score, low + (high - low) * unit_grid(count, GRID[count]))
    else:
        for number in range(count):
            lines = np.repeat(best[None], SCAN, axis=0)
            lines[:, number] = np.linspace(low[number], high[number], SCAN)
            best = _top(score, lines)
    reach = (high - low) / (GRID.get(count, SCAN) - 1)
    simplex = best + np.vstack(
        [np.zeros(count), np.diag(np.where(best > 0.5 * (low + high), -reach, reach))]
    )
    found = optimize.minimize(
        lambda unit: -score(unit),
        best,
        method="Nelder-Mead",
        bounds=list(zip(low, high, strict=True)),
        options={"xatol": FINEST, "fatol": 0.05, "maxfev": 60 * count, "initial_simplex": simplex},
    )
    return found.x


def _top(score, points):
    """Return the best of points (point, parameter)."""
    return points[np.argmax([score(point) for point in points])]


def _profile(score, unit, box=None):
    """Return [(values (n,), score (n,))] along each parameter through the best, within a box
    (parameter, 2), the others following the ridge that the curvature there tells.
    """
    count = len(unit)
    at, step = np.clip(unit, CURVED, 1.0 - CURVED), CURVED * np.eye(count)
    bent = np.array(
        [
            [
                score(at + a + b) - score(at + a - b) - score(at - a + b) + score(at - a - b)
                for b in step
            ]
            for a in step
        ]
    ) / (4.0 * CURVED**2)
    values, turn = np.linalg.eigh(-0.5 * (bent + bent.T))
    covariance = (turn / np.maximum(values, 1.0 / WIDEST**2)) @ turn.T
    out = []
    for number in range(count):
        sd = np.sqrt(covariance[number, number])
        ridge = covariance[:, number] / covariance[number, number]
        near = unit[number] + sd * np.linspace(-4.0, 4.0, 33)
        axis = np.unique(
            np.clip(
                np.concatenate([near, np.linspace(0.0, 1.0, 21)]),
                *((0.0, 1.0) if box is None else box[number]),
            )
        )
        points = np.clip(unit + (axis - unit[number])[:, None] * ridge, 0.0, 1.0)
        out.append((axis, np.array([score(point) for point in points])))
    return out


def _lows(parameters, scores):
    """Return the function unit -> log likelihood of the lowest record, between the simulated
    parameters (point, parameter).
    """
    if np.ptp(scores) == 0.0 or len(scores) <= parameters.shape[1] + 1:
        return lambda unit: float(scores[np.argmin(np.sum((parameters - unit) ** 2, axis=1))])
    interpolator = RBFInterpolator(
        parameters, scores, kernel="linear", degree=0, smoothing=SMOOTHING
    )
    return lambda unit: float(interpolator(np.atleast_2d(unit))[0])


def _above(values, score, start, drop=NINETY + SCATTER):
    """Return (low, high) of the values whose score is within `drop` of the best uphill from start,
    between grid points by parabola and line.
    """
    best = _uphill(score, int(np.argmin(np.abs(values - start))))
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
        share = (
            np.sqrt(share) if place == best else share
        )  # beside a peak the score falls with the square
        ends.append(values[place] + share * (values[place + step] - values[place]))
    return np.clip(ends, 0.0, 1.0)


def _uphill(score, place):
    """Return the place of the top that score (n,) rises to from a place: far from what was
    simulated the emulator forgives what it does not know, and may be higher.
    """
    while True:
        higher = max(range(max(place - 1, 0), min(place + 2, len(score))), key=score.__getitem__)
        if score[higher] <= score[place]:
            return place
        place = higher
