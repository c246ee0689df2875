"""Where the parameters of an explanation may lie."""

import numpy as np
from scipy.optimize import brentq
from scipy.stats import qmc

from .evidence import Fit, Likelihoods
from .null import Null
from .trials import AnyEmulator

DRAWS = 256
MOVES = 3  # of every sample at each temperature


def estimate(emulator: AnyEmulator, null: Null, found: Fit) -> tuple[np.ndarray, np.ndarray]:
    """Return (unit (parameter,), interval (parameter, 2)): the mean of the parameters of an
    explanation, normalised, and the ends that hold 90 % of them and the mean.

    Where much more is left at the mean than where least is, as in a bent valley, it is the place of
    the least.
    """
    samples = drawn(emulator, null, found.unit.size)
    mean = samples.mean(axis=0)
    left = Likelihoods.of(emulator, np.stack([mean, found.unit]), null).expected
    unit = mean if left[0] < left[1] + mean.size else found.unit
    low, high = np.quantile(samples, (0.05, 0.95), axis=0)
    return unit, np.stack([np.minimum(low, unit), np.maximum(high, unit)], axis=1)


def drawn(emulator: AnyEmulator, null: Null, count: int, seed: int = 5) -> np.ndarray:
    """Return (sample, parameter): draws of `count` parameters of an explanation, normalised.

    Even samples of the whole range, weighted by a power of the likelihood that grows to one, drawn
    again and moved (sequential Monte Carlo, Del Moral et al. 2006): the few even samples that lie
    in a narrow valley say nothing of its length.
    """
    random = np.random.default_rng(seed)

    def chance(units):
        return Likelihoods.of(emulator, units, null).over_laws

    samples = qmc.Sobol(count, seed=seed).random(DRAWS)
    known, power = chance(samples), 0.0
    while power < 1.0:
        step = next_step(known, power)
        power += step
        weight = np.exp(step * (known - known.max()))
        chosen = random.choice(DRAWS, p=weight / weight.sum(), size=DRAWS)
        samples, known = samples[chosen], known[chosen]
        spread = samples.std(axis=0).max() * 0.5 + 1.0e-6
        for _ in range(MOVES):
            # along the line through two others: a valley is followed (ter Braak 2006)
            first, second = random.permutation(DRAWS), random.permutation(DRAWS)
            along = random.choice([0.1, 0.5, 1.0], DRAWS)[:, None]
            near = 0.01 * spread * random.standard_normal(samples.shape)
            moved = reflected(samples + along * (samples[first] - samples[second]) + near)
            there = chance(moved)
            better = np.log(random.random(DRAWS)) < power * (there - known)
            samples, known = (
                np.where(better[:, None], moved, samples),
                np.where(better, there, known),
            )
    return samples


def next_step(known: np.ndarray, power: float) -> float:
    """Return by how much the power of log likelihoods (sample,) may grow with half of the samples
    still counting, at most to 1.
    """

    def counting(step):
        weight = np.exp(step * (known - known.max()))
        return weight.sum() ** 2 / np.sum(weight**2) - 0.5 * len(known)

    rest = 1.0 - power
    return rest if counting(rest) > 0.0 else float(brentq(counting, 0.0, rest))


def reflected(units: np.ndarray) -> np.ndarray:
    """Return units (..., parameter), those outside their range reflected at its ends."""
    return 1.0 - np.abs(1.0 - np.abs(units) % 2.0)
