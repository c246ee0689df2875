"""Standard errors from the scatter of a record's own segments: they also feel what is not Gaussian,
as the impacts are not.
"""

import numpy as np


def segment_covariance(changes, averages):
    """Return the covariance (parameter, parameter) of an estimate from the influence of each
    segment on it.

    changes: (segment, parameter), how far one segment alone pulls the estimate (the estimate is
    close to the mean of these pulls); averages: effective degrees of freedom nu of the averaged
    spectrum, nu/2 independent segments. The overlap that makes nu/2 smaller than the number of
    segments also makes their scatter about their own mean too small, hence nu/2 - 1. Infinite for
    fewer than 2.
    """
    changes = changes - changes.mean(axis=0)
    independent = 0.5 * averages
    if independent <= 2.0:
        return np.full((changes.shape[1], changes.shape[1]), np.inf)
    return changes.T @ changes / len(changes) / (independent - 1.0)


def left_out_changes(estimates):
    """Return (segment, parameter) influences from estimates (segment, parameter) made with one of
    the segments left out.
    """
    return -(len(estimates) - 1.0) * (estimates - estimates.mean(axis=0))


def effective_duration(averages, kernel):
    """Return the length in s of a record with as many independent values per Hz as the averaged
    spectrum has (near the true length).
    """
    shared = 2.0 * kernel.bin_correlation.sum() - 1.0  # neighbouring bins share the window
    return averages / (2.0 * kernel.spacing_Hz * shared)


def widened(covariance, changes, averages):
    """Return the covariance, made wider where the segments scatter more than it says; never
    narrower.

    One factor for all parameters, the mean of the variance ratios: each ratio alone is as noisy as
    nu/2 segments make it.
    """
    if not np.isfinite(averages):
        return covariance
    measured = segment_covariance(changes, averages)
    if not np.all(np.isfinite(measured)):
        return covariance
    return covariance * max(1.0, np.trace(np.linalg.solve(covariance, measured)) / len(covariance))
