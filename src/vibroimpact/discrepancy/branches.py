"""Records that go one of two ways with the same force and the same model: what parts the ways is left free.

Where impacts are few a motion may jump, and stay, so that of eight runs six have a resonance that two have not. A measurement is one run. That it went the other way than
the mean of the runs is no evidence against a model that goes both.
"""

import numpy as np
from scipy import linalg

from vibroimpact.discrepancy.features import compressed
from vibroimpact.discrepancy.neighbourhood import near, nearest

PARTED = 90.0  # of chi-square above the number of features: three sigma of 270 features, see naming.SPREAD
TOWARDS = 5.0  # sigma: two runs of one law differ by less along what is left of the measurement


def branch_direction(free, null, measured, path, unit, periodic):
    """Return (1, record, compressed feature): along what pairs of runs of a path near unit (parameter,) differ by more than chance, in all or towards measured (record,
    feature), as long as they differ there; zeros in records where none do. free (direction, record, compressed feature): what is free without it."""
    rows = compressed(path.differences[near(path, unit, periodic)], null) / np.sqrt(2.0)
    left = compressed(measured - path.features[nearest(path, unit, periodic)], null)
    return np.array([_parting(rows[:, record], left[record], covariance) for record, covariance in enumerate(null.freed(free).covariance)])[None]


def with_branch(free, null, measured, path, unit, periodic):
    """Return directions free (direction, record, compressed feature) and the branch_direction of a path there, as they are where there are none."""
    return np.concatenate([free, branch_direction(free, null, measured, path, unit, periodic)]) if len(free) else free


def _parting(rows, left, covariance):
    """Return (feature,) what parts rows (pair, feature), differences of two runs over sqrt(2), that are no chance under a covariance (feature, feature)."""
    factor = linalg.cholesky(covariance, lower=True)
    white = linalg.solve_triangular(factor, rows.T, lower=True).T
    towards = linalg.solve_triangular(factor, left, lower=True)
    parted = white[(np.sum(white**2, axis=1) > len(covariance) + PARTED) | (np.abs(white @ towards) > TOWARDS * np.linalg.norm(towards))]
    if not len(parted):
        return np.zeros(len(covariance))
    size, along = linalg.svd(parted, full_matrices=False)[1:]
    return np.sqrt(2.0 / len(parted)) * size[0] * (factor @ along[0])
