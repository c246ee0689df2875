"""Standard errors from the scatter of a record's own segments.

They include parts of the response that are not Gaussian, such as impacts.
"""

import numpy as np

from vibroimpact.identify.spectra.window_leakage import SpectralKernel


def segment_covariance(changes: np.ndarray, averages: float) -> np.ndarray:
    """Return the covariance (parameter, parameter) of an estimate from the segments' influences.

    The overlap that makes nu/2 smaller than the number of segments also makes their scatter about
    their own mean too small, hence nu/2 - 1. Infinite for fewer than 2 independent segments.

    changes: (segment, parameter), by how much one segment alone changes the estimate; the estimate
        is close to the mean of these changes.
    averages: effective degrees of freedom nu of the averaged spectrum: nu/2 independent segments.
    """
    changes = changes - changes.mean(axis=0)
    independent = 0.5 * averages
    if independent <= 2.0:
        return np.full((changes.shape[1], changes.shape[1]), np.inf)
    return changes.T @ changes / len(changes) / (independent - 1.0)


def jackknife_influences(estimates: np.ndarray) -> np.ndarray:
    """Return the influences (segment, parameter) of segments on an estimate.

    estimates: (segment, parameter), each made with one segment left out.
    """
    return -(len(estimates) - 1.0) * (estimates - estimates.mean(axis=0))


def effective_duration(averages: float, kernel: SpectralKernel) -> float:
    """Return the length in s of a record with as many independent values per Hz as the spectrum.

    It is near the true length of the record.

    averages: effective degrees of freedom of a bin.
    """
    shared = 2.0 * kernel.bin_correlation.sum() - 1.0  # because neighbouring bins share the window
    return averages / (2.0 * kernel.spacing_Hz * shared)


def widened(covariance: np.ndarray, changes: np.ndarray, averages: float) -> np.ndarray:
    """Return the covariance, widened if the segments scatter more than it predicts.

    It is never made narrower. One factor serves all parameters, the mean of the variance ratios:
    each ratio alone is as noisy as nu/2 segments make it. Arguments as in segment_covariance.
    """
    if not np.isfinite(averages):
        return covariance
    measured = segment_covariance(changes, averages)
    if not np.all(np.isfinite(measured)):
        return covariance
    ratio = np.trace(np.linalg.solve(covariance, measured)) / len(covariance)
    return covariance * max(1.0, ratio)
