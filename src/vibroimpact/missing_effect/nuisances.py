"""What a structure may differ by from its model though no effect is missing: draws of frequencies,
damping and gains, given what the lowest record tells of them.
"""

import numpy as np
from scipy import linalg

from vibroimpact.linear_stage import nuisance as linear
from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.workbench import Workbench

from . import constants


def nuisance_draws(bench: Workbench, count: int, seed: int) -> list[linear.Nuisance]:
    """Return `count` Nuisances of a Workbench: of the modes that its lowest record shows from
    their posterior, of the others from their prior.

    Modes that are not seen have one common factor of damping beside their own, since what they
    dissipate has one cause. Modes that are seen and do not tell it, as the response is nonlinear,
    have it too: their damping is off by no more than it seems to be.
    """
    random = np.random.default_rng(seed)
    channels, modes = len(bench.signals.names), bench.bare.modes
    seen, mean, root = _posterior(bench)
    unseen = np.setdiff1d(np.flatnonzero(bench.bare.omega > 0.0), seen)
    common = common_damping(bench)[unseen]
    out = []
    for _ in range(count):
        told = mean + root @ random.standard_normal(len(mean))
        frequency, damping = np.zeros(modes), np.zeros(modes)
        frequency[seen] = priors.FREQUENCY_SD * told[: len(seen)]
        damping[seen] = priors.DAMPING_SD * told[len(seen) : 2 * len(seen)]
        frequency[unseen] = priors.FREQUENCY_SD * random.standard_normal(len(unseen))
        damping[unseen] = common * random.standard_normal() + priors.DAMPING_SD * (
            random.standard_normal(len(unseen))
        )
        gain = 1.0 + priors.GAIN_SD * told[2 * len(seen) :]
        out.append(
            linear.Nuisance(np.arange(modes), np.exp(frequency), np.exp(damping), gain[:channels])
        )
    return out


def common_damping(bench: Workbench) -> np.ndarray:
    """Return (mode,): one standard deviation of the logarithm of the common factor of damping."""
    out = np.full(bench.bare.modes, np.log(priors.UNSEEN_DAMPING))
    if bench.linear_stage and not bench.modes_told:
        seems = float(np.sqrt(np.mean(bench.measured_fit.log_damping**2)))
        out[bench.measured_fit.modes] = np.log(max(priors.UNSEEN_DAMPING, np.exp(-seems)))
    return out


def clearance_draws(count: int, seed: int) -> np.ndarray:
    """Return (count,): what all clearances are multiplied by."""
    random = np.random.default_rng([seed, 1])
    return np.exp(constants.CLEARANCE_SD * random.standard_normal(count))


def _posterior(bench):
    """Return (modes that are seen, mean (nuisance,), root (nuisance, nuisance) of the covariance)
    of frequencies and damping of those modes and of gains, in units of their priors.
    """
    channels = len(bench.signals.names)
    if not (bench.linear_stage and bench.modes_told):
        return np.zeros(0, int), np.zeros(channels), np.eye(channels)
    fit = bench.measured_fit
    values, covariance, sensitivity = linear.difference(bench.measured_reading, bench.bare_reading)
    wide, _ = linear.spread(values, covariance, sensitivity)
    sensitivity = sensitivity * wide
    factor = linalg.cho_factor(covariance + sensitivity @ sensitivity.T, lower=True)
    mean = wide * (sensitivity.T @ linalg.cho_solve(factor, values))
    left = np.eye(len(mean)) - sensitivity.T @ linalg.cho_solve(factor, sensitivity)
    left = wide[:, None] * left * wide
    size, along = linalg.eigh(0.5 * (left + left.T))
    limit = priors.CORRECTION_LIMIT
    return (
        fit.modes,
        np.clip(mean, -limit, limit),
        along * np.sqrt(np.clip(size, 0.0, None)),
    )
