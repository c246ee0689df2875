"""How probable a record's features are under a model, given their scatter from seed to seed and
what two codes differ by.
"""

from dataclasses import dataclass

import numpy as np
from scipy import linalg
from scipy.linalg import lapack

from . import priors
from .features import compressed


@dataclass(frozen=True)
class Scatter:
    """Mean and covariance of a record's features over null seeds: mean (feature,), covariance
    (feature, feature), of one record.
    """

    mean: np.ndarray
    covariance: np.ndarray


def scatter_of(features, layout):
    """Return the Scatter of (seed, feature)."""
    mean = features.mean(axis=0)
    return Scatter(mean, shrunk(compressed(features - mean, layout), max(len(features) - 1, 1)))


def shrunk(rows, freedom):
    """Return the covariance (feature, feature) of compressed deviations rows (run, feature) with as
    many degrees of freedom, shrunk towards its diagonal (O. Ledoit, M. Wolf, J. Multivariate Anal.
    88, 2004).
    """
    sd = np.sqrt(np.maximum(np.sum(rows**2, axis=0) / freedom, 1.0e-12))
    unit = rows / sd
    correlation = unit.T @ unit / freedom
    off = correlation - np.diag(np.diag(correlation))
    # sum over runs of |their outer product less the correlation|^2
    squares = (
        np.sum(np.sum(unit**2, axis=1) ** 2)
        - 2.0 * np.sum((unit @ correlation) * unit)
        + len(rows) * np.sum(correlation**2)
    )
    shrink = min(1.0, squares / len(rows) ** 2 / max(np.sum(off**2), 1.0e-12))
    return ((1.0 - shrink) * off + np.eye(len(sd))) * np.outer(sd, sd)


def feature_sd(layout):
    """Return (feature,): one sigma of what two codes differ by."""
    return np.array([priors.FEATURE_SD[kind] for kind in layout.kind])


def free_directions(layout, driven):
    """Return (direction, feature): common levels of channels driven (channel,) by the force and of
    those not, one sigma each.
    """
    rows = []
    for group in (True, False):
        chosen = (layout.kind == "power") & (driven[layout.channel] == group)
        if chosen.any():
            rows.append(np.where(chosen, priors.LEVEL_SD[group], 0.0))
    return np.array(rows).reshape(-1, len(layout.kind))


def log_likelihood(residual, covariance, change=None, groups=None, more_variance=None):
    """Return (log likelihood, chi-square) of a compressed residual (feature,), measured less
    simulated mean, by a multivariate t law.

    covariance (feature, feature): of seeds and of what two codes differ by; change (feature,): what
    the effect changes, of which LAW_SD is uncertain feature by feature and LAW_COMMON_SD in each
    group of features of groups (feature,); more_variance (feature,): of the mean.
    """
    total = np.array(covariance) if change is None else _with_law(covariance, change, groups)
    if more_variance is not None:
        total.reshape(-1)[:: len(residual) + 1] += more_variance
    factor, failed = lapack.dpotrf(
        total.T, lower=1, overwrite_a=1
    )  # called thousands of times a run: without the wrapper's checks and copies
    if failed:
        raise linalg.LinAlgError("the covariance of features is not positive definite")
    white = lapack.dtrtrs(factor, residual, lower=1)[0]
    return _t_law(white, np.log(np.diag(factor)))


class LawLikelihood:
    """The log likelihood where an effect's change stays as it is and the variance of the mean is a
    multiple of `spread` (feature,): the covariance is made diagonal once, and every residual costs
    a product with a matrix. Arguments as of `log_likelihood`.
    """

    def __init__(self, covariance, change, groups, spread):
        self.scale = np.sqrt(np.maximum(spread, LEAST_SPREAD * max(spread.mean(), LEAST_SPREAD)))
        self.values, turn = linalg.eigh(
            _with_law(covariance, change, groups) / np.outer(self.scale, self.scale),
            check_finite=False,
        )
        self.turn = turn.T / self.scale
        self.log_scale = float(np.sum(np.log(self.scale)))

    def __call__(self, residual, multiple):
        """Return the log likelihood of a compressed residual (feature,) where the mean's variance
        is `multiple` times the spread.
        """
        sd = np.sqrt(self.values + multiple)
        return _t_law(self.turn @ residual / sd, np.log(sd))[0] - self.log_scale


LEAST_SPREAD = 1.0e-6  # of the mean over features


def _with_law(covariance, change, groups):
    """Return covariance (feature, feature) with what two laws of one effect differ by."""
    common = np.array(
        [
            np.where(groups == group, priors.LAW_COMMON_SD * change, 0.0)
            for group in np.unique(groups)
        ]
    )
    total = covariance + common.T @ common
    total.reshape(-1)[:: len(change) + 1] += (priors.LAW_SD * change) ** 2
    return total


def _t_law(white, log_sd):
    """Return (log likelihood, chi-square) of a whitened residual (feature,) and the logarithms of
    what it was divided by.
    """
    chi_square = float(white @ white)
    return (
        -0.5 * (priors.TAIL + len(white)) * np.log1p(chi_square / priors.TAIL)
        - float(np.sum(log_sd)),
        chi_square,
    )
