"""The covariance of a record's features: their scatter over seeds, and the model discrepancy.

Model discrepancy is the difference between two correct codes of the same physics.
"""

import numpy as np

from vibroimpact.linear_stage import priors
from vibroimpact.observation.features import FeatureLayout


def shrunk(rows: np.ndarray, freedom: int) -> np.ndarray:
    """Return the covariance (feature, feature) of deviations, shrunk towards its diagonal.

    rows (run, feature): compressed deviations from a mean. freedom: their degrees of freedom.
    O. Ledoit, M. Wolf, J. Multivariate Anal. 88, 2004.
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


def feature_sd(layout: FeatureLayout) -> np.ndarray:
    """Return (feature,): one sigma of the difference between two codes."""
    return np.array([priors.FEATURE_SD[kind] for kind in layout.kind])


def free_directions(layout: FeatureLayout, driven: np.ndarray) -> np.ndarray:
    """Return (direction, feature): one sigma of a level difference between two codes that is common
    to all driven channels, and of one common to all others.

    driven (channel,) bool: see driven_channels.
    """
    rows = []
    for group in (True, False):
        chosen = (layout.kind == "power") & (driven[layout.channel] == group)
        if chosen.any():
            rows.append(np.where(chosen, priors.LEVEL_SD[group], 0.0))
    return np.array(rows).reshape(-1, len(layout.kind))
