"""Runs of one model with the same force: how far they lie apart, and records that go one of two
ways, where what parts the ways is left free.

Where impacts are few a motion may jump, and stay, so that of eight runs six have a resonance that
two have not. A measurement is one run. That it went the other way than the mean of the runs is no
evidence against a model that goes both.
"""

import numpy as np
from scipy import linalg

from .features import compressed
from .neighbourhood import near, nearest

# of chi-square above the number of features: three sigma of 270 features, see naming.SPREAD
PARTED = 90.0
TOWARDS = 5.0  # sigma: two runs of one law differ by less along what is left of the measurement


def branch_direction(free, null, measured, path, unit, periodic):
    """Return (1, record, compressed feature): along what pairs of runs of a path near unit
    (parameter,) differ by more than chance, in all or towards measured (record, feature), as long
    as they differ there; zeros in records where none do. free (direction, record, compressed
    feature): what is free without it.
    """
    rows = compressed(path.differences[near(path, unit, periodic)], null) / np.sqrt(2.0)
    left = compressed(measured - path.features[nearest(path, unit, periodic)], null)
    return np.array(
        [
            _parting(rows[:, record], left[record], covariance)
            for record, covariance in enumerate(null.freed(free).covariance)
        ]
    )[None]


def with_branch(free, null, measured, path, unit, periodic):
    """Return directions free (direction, record, compressed feature) and the branch_direction of a
    path there, as they are where there are none.
    """
    return (
        np.concatenate([free, branch_direction(free, null, measured, path, unit, periodic)])
        if len(free)
        else free
    )


def deviations(null, features, path, unit, periodic):
    """Return (record, run, compressed feature): how far runs lie off the mean of a model's, each
    with the variance of one: of features (record, seed, feature), and of pairs of runs of a path
    near unit (parameter,).
    """
    seeds = features.shape[1]
    own = compressed(features - features.mean(axis=1, keepdims=True), null) * np.sqrt(
        seeds / max(seeds - 1, 1)
    )
    return np.concatenate([own, pair_deviations(null, path, unit, periodic)], axis=1)


def pair_deviations(null, path, unit, periodic):
    """Return the deviations of pairs of runs of a path near unit (parameter,) alone."""
    pairs = path.differences[near(path, unit, periodic)]
    return np.swapaxes(compressed(pairs[pairs.any(axis=(1, 2))], null), 0, 1) / np.sqrt(2.0)


def searched_by(null, measured, path, unit, periodic, free):
    """Return the Null that points of a path near unit (parameter,) are compared by: with directions
    free (direction, record, compressed feature), with what parts its runs, and with how far they
    lie apart; as it is where nothing is free.
    """
    if not len(free):
        return null
    return null.freed(with_branch(free, null, measured, path, unit, periodic)).scattered(
        pair_deviations(null, path, unit, periodic)
    )


def _parting(rows, left, covariance):
    """Return (feature,) what parts rows (pair, feature), differences of two runs over sqrt(2), that
    are no chance under a covariance (feature, feature).
    """
    factor = linalg.cholesky(covariance, lower=True)
    white = linalg.solve_triangular(factor, rows.T, lower=True).T
    towards = linalg.solve_triangular(factor, left, lower=True)
    parted = white[
        (np.sum(white**2, axis=1) > len(covariance) + PARTED)
        | (np.abs(white @ towards) > TOWARDS * np.linalg.norm(towards))
    ]
    if not len(parted):
        return np.zeros(len(covariance))
    size, along = linalg.svd(parted, full_matrices=False)[1:]
    return np.sqrt(2.0 / len(parted)) * size[0] * (factor @ along[0])
