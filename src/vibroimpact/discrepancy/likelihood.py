"""How probable a record's features are under a model, given their scatter from seed to seed and what two codes differ by."""

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from vibroimpact.discrepancy import priors
from vibroimpact.discrepancy.features import compressed


@dataclass(frozen=True)
class Scatter:
    """Mean and covariance of a record's features over null seeds: mean (feature,), covariance (feature, feature), of one record."""

    mean: np.ndarray
    covariance: np.ndarray


def scatter_of(features):
    """Return the Scatter of (seed, feature): covariance shrunk towards its diagonal (O. Ledoit, M. Wolf, J. Multivariate Anal. 88, 2004)."""
    count, size = features.shape
    mean = features.mean(axis=0)
    centred = compressed(features - mean)
    variance = np.sum(centred**2, axis=0) / max(count - 1, 1)
    sd = np.sqrt(np.maximum(variance, 1.0e-12))
    unit = centred / sd
    correlation = unit.T @ unit / max(count - 1, 1)
    off = correlation - np.diag(np.diag(correlation))
    spread = sum(np.sum((np.outer(row, row) - correlation) ** 2) for row in unit) / count**2
    shrink = min(1.0, spread / max(np.sum(off**2), 1.0e-12))
    correlation = (1.0 - shrink) * off + np.eye(size)
    # a variance from few seeds is itself uncertain: halfway to the median of its neighbours it is less so
    return Scatter(mean, correlation * np.outer(sd, sd))


def feature_sd(layout):
    """Return (feature,): one sigma of what two codes differ by."""
    return np.array([priors.FEATURE_SD[kind] for kind in layout.kind])


def log_likelihood(measured, mean, scatter, base_sd, seeds, law_change=None):
    """Return (log likelihood, chi-square) of measured (feature,) under a mean (feature,) estimated from `seeds` runs.

    law_change (feature,): what the effect changes; LAW_SD of it is what two codes may differ by.
    """
    covariance = scatter.covariance * (1.0 + 1.0 / seeds) + np.diag(base_sd**2)
    if law_change is not None:
        covariance = covariance + np.diag((priors.LAW_SD * law_change) ** 2)
    factor = linalg.cholesky(covariance, lower=True)
    white = linalg.solve_triangular(factor, compressed(measured - mean), lower=True)
    chi_square = float(white @ white)
    return -0.5 * chi_square - float(np.sum(np.log(np.diag(factor)))), chi_square
