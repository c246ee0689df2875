"""How probable the measurement is under an explanation, whatever its parameters, and under
something that no explanation holds.
"""

from dataclasses import dataclass

import numpy as np
from scipy import linalg
from scipy.special import logsumexp
from scipy.stats import qmc

from . import constants

SAMPLES = 256
NEAR = 128  # samples about the best so far
SPREAD = 0.06  # of the searched range: of those


@dataclass(frozen=True)
class Fit:
    """What a Trial says: log_evidence against nothing; by_law (law,): the same by each of
    constants.LAWS, with its prior; unit (parameter,) the most probable; samples (sample,
    parameter) with weight (sample,): the posterior; mean (value,) the change there; left:
    chi-square that remains; error: standard deviation of that by what the emulator does not know.
    """

    log_evidence: float
    by_law: np.ndarray
    unit: np.ndarray
    samples: np.ndarray
    weight: np.ndarray
    mean: np.ndarray
    left: float
    hidden: float


def fit(emulator, count, null, start=None, seed=3):
    """Return the Fit of an Emulator of `count` parameters against a Null; start (parameter,): where
    the answer is near, None.
    """
    first = qmc.Sobol(count, seed=seed).random(SAMPLES)
    if start is not None:
        first[0] = start
    shares = [law for law, _ in constants.LAWS]
    even = [log_likelihoods(emulator, first, null, law) for law in shares]
    best = first[np.argmax(np.logaddexp.reduce([chance for chance, _ in even]))]
    near = np.clip(
        best + SPREAD * np.random.default_rng(seed).standard_normal((NEAR, count)), 0.0, 1.0
    )
    about = [log_likelihoods(emulator, near, null, law) for law in shares]
    by_law = np.array(
        [
            np.log(prior) + _evidence(*pair, best, near)
            for (_, prior), *pair in zip(constants.LAWS, even, about, strict=True)
        ]
    )
    samples = np.vstack([first, near])
    chances = constants.POWER * np.concatenate(
        [np.stack([chance for chance, _ in rows], axis=1) for rows in (even, about)]
    )
    chances = logsumexp(chances + np.log([prior for _, prior in constants.LAWS]), axis=1)
    weight = chances - np.log(np.append(np.ones(SAMPLES), np.maximum(_proposal(near, best), 1.0)))
    unit = samples[np.argmax(chances)]
    mean, variance = emulator(unit)
    change = mean[0] @ emulator.directions
    rest = null.measured - change
    return Fit(
        float(logsumexp(by_law)),
        by_law,
        unit,
        samples,
        np.exp(weight - logsumexp(weight)),
        change,
        float(rest @ rest),
        _hidden(emulator.directions @ rest, variance[0]),
    )


def _hidden(rest, variance):
    """Return by how much less chi-square may remain within two standard deviations of the emulator:
    rest, variance (direction,).
    """
    near = np.maximum(np.abs(rest) - 2.0 * np.sqrt(variance), 0.0)
    return float(np.sum(rest**2 - near**2))


def _proposal(near, best):
    """Return (sample,): the density of samples about the best, per unit volume."""
    away = np.sum(((near - best) / SPREAD) ** 2, axis=1)
    return np.maximum(
        np.exp(-0.5 * away) / (np.sqrt(2.0 * np.pi) * SPREAD) ** near.shape[1], 1.0e-12
    )


def _evidence(first, nearby, best, near):
    """Return the log evidence, tempered, over the prior: evenly over the range where the effect is
    seen. first, nearby: (log likelihood, seen) of even samples and of those about the best.
    """
    whole = np.concatenate([first[1], nearby[1]])
    share = max(first[1].mean(), 1.0 / SAMPLES)
    if not whole.any():
        return -np.inf
    even = logsumexp(constants.POWER * np.where(first[1], first[0], -np.inf)) - np.log(SAMPLES)
    # about the best: importance samples, which find a peak that even samples step over
    peak = logsumexp(
        np.where(nearby[1], constants.POWER * nearby[0], -np.inf)
        - np.log(np.maximum(_proposal(near, best), 1.0))
    ) - np.log(NEAR)
    return float(max(even, peak) - np.log(share))


def log_likelihoods(emulator, units, null, law):
    """Return (log likelihood against nothing, seen), (point,) each, at units (point, parameter).

    The covariance is that of the null, what the law may differ by, and what the emulator does not
    know along its directions.
    """
    mean, variance = emulator(units)
    change = mean @ emulator.directions
    diagonal = 1.0 + (law * change) ** 2
    columns = [np.sqrt(variance)[:, :, None] * emulator.directions]
    for group in np.unique(null.groups):
        columns.append((constants.LAW_COMMON * law * change * (null.groups == group))[:, None])
    columns = np.concatenate(columns, axis=1)
    rest = null.measured - change
    weighted = columns / diagonal[:, None]
    inner = np.eye(columns.shape[1]) + weighted @ columns.transpose(0, 2, 1)
    along = np.einsum("pkv,pv->pk", weighted, rest)
    solved = np.linalg.solve(inner, along[..., None])[..., 0]
    square = np.sum(rest**2 / diagonal, axis=1) - np.sum(along * solved, axis=1)
    size = np.sum(np.log(diagonal), axis=1) + np.linalg.slogdet(inner)[1]
    return (
        -0.5 * (square + size - null.measured @ null.measured),
        np.sum(change**2, axis=1) > constants.SEEN,
    )


class SomethingElse:
    """The likelihood of what looks like effects but is none that was tried: changes (run, value) of
    all trials.
    """

    def __init__(self, changes, noise, null):
        self.null = null
        size = np.sqrt(np.maximum(np.sum(changes**2, axis=1) - noise * null.values, 0.0))
        told = size > np.sqrt(constants.SEEN)
        unit = changes[told] / np.linalg.norm(changes[told], axis=1, keepdims=True)
        _, singular, self.directions = linalg.svd(unit, full_matrices=False)
        self.share = (1.0 - constants.WHITE) * null.values * singular**2 / max(len(unit), 1)
        self.sizes = np.geomspace(*constants.SIZES, 24)

    def log_evidence(self, mean):
        """Return the tempered log evidence against nothing that the measurement is mean (value,)
        and something else.
        """
        rest = self.null.measured - mean
        along = self.directions @ rest
        outside = rest @ rest - along @ along
        white = 1.0 + constants.WHITE * self.sizes**2
        inside = white[:, None] + self.sizes[:, None] ** 2 * self.share
        chance = -0.5 * (
            np.sum(along**2 / inside + np.log(inside), axis=1)
            + outside / white
            + (self.null.values - len(along)) * np.log(white)
            - self.null.measured @ self.null.measured
        )
        return float(logsumexp(constants.POWER * chance) - np.log(len(self.sizes)))
