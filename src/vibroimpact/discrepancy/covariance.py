"""The covariance of a record's features: their scatter from seed to seed, and what two codes differ
by.
"""

import numpy as np

from . import priors


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
