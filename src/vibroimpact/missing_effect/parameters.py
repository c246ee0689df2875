"""Where the parameters of an explanation may lie."""

import numpy as np
from scipy.special import logsumexp

from .evidence import Fit, Likelihoods
from .null import Null
from .trials import AnyEmulator

DRAWS = 512
ROUNDS = 5
LEAST = 0.01  # of the searched range: standard deviation of the kernel that samples are drawn by


def estimate(emulator: AnyEmulator, null: Null, found: Fit) -> tuple[np.ndarray, np.ndarray]:
    """Return (unit (parameter,), interval (parameter, 2)): the mean of the parameters of an
    explanation, normalised, and the ends that hold 90 % of them and the mean.

    Where much more is left at the mean than where least is, as in a bent valley, it is the place of
    the least.
    """
    samples, weight = drawn(emulator, null, found)
    mean = weight @ samples
    left = Likelihoods.of(emulator, np.stack([mean, found.unit]), null).expected
    unit = mean if left[0] < left[1] + mean.size else found.unit
    low, high = weighted_interval(samples, weight)
    return unit, np.stack([np.minimum(low, unit), np.maximum(high, unit)], axis=1)


def drawn(
    emulator: AnyEmulator, null: Null, found: Fit, seed: int = 5
) -> tuple[np.ndarray, np.ndarray]:
    """Return (samples (sample, parameter), weight (sample,)) of the parameters of an explanation,
    normalised.

    The few even samples of a Fit that lie in a narrow valley say nothing of its length: new ones
    are drawn about them, weighted by the likelihood, and drawn about again (population Monte Carlo,
    Cappé et al. 2004).
    """
    random = np.random.default_rng(seed)
    samples, weight = found.samples, found.weight
    for _ in range(ROUNDS):
        spread = np.linalg.cholesky(kernel_of(samples, weight))
        chosen = random.choice(len(samples), p=weight, size=DRAWS)
        new = samples[chosen] + random.standard_normal((DRAWS, samples.shape[1])) @ spread.T
        new = 1.0 - np.abs(1.0 - np.abs(new) % 2.0)  # reflected at the ends of the range
        density = density_of(new, samples, weight, spread)
        told = Likelihoods.of(emulator, new, null)
        chance = told.over_laws - density
        samples, weight = new, np.exp(chance - logsumexp(chance))
    return samples, weight


def kernel_of(samples: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return (parameter, parameter): covariance of the kernel that smooths weighted samples, of the
    width of Silverman (1986).
    """
    count = samples.shape[1]
    away = samples - weight @ samples
    effective = max(1.0 / np.sum(weight**2), 1.0)
    width = (4.0 / ((count + 2.0) * effective)) ** (1.0 / (count + 4.0))
    return width**2 * (away.T * weight) @ away + LEAST**2 * np.eye(count)


def density_of(
    new: np.ndarray, samples: np.ndarray, weight: np.ndarray, spread: np.ndarray
) -> np.ndarray:
    """Return (sample,): log density at new (sample, parameter) of kernels, of Cholesky factor
    spread, at samples with weight.
    """
    away = np.linalg.solve(spread, (new[:, None] - samples[None]).reshape(-1, new.shape[1]).T)
    square = np.sum(away**2, axis=0).reshape(len(new), len(samples))
    return logsumexp(-0.5 * square, axis=1, b=weight) - np.log(np.diag(spread)).sum()


def weighted_interval(
    samples: np.ndarray, weight: np.ndarray, ends: tuple[float, float] = (0.05, 0.95)
) -> tuple[np.ndarray, np.ndarray]:
    """Return (low, high), (parameter,) each, that hold 90 % of samples (sample, parameter)."""
    out = np.empty((2, samples.shape[1]))
    for number, column in enumerate(samples.T):
        order = np.argsort(column)
        known = np.cumsum(weight[order])
        out[:, number] = np.interp(ends, known / known[-1], column[order])
    return out[0], out[1]
