"""Runs that were thrown off, and those that were not: a structure that was measured was not, so it
is compared with the latter.
"""

import numpy as np

from vibroimpact.integration.contact_convergence import IntegrationError

LEAST = 0.5  # of the runs of every record


def survivors(features):
    """Return (record, run) the indices of runs of features (record, run, feature) that are finite,
    as many of every record.

    Raises IntegrationError where fewer than half of a record's are.
    """
    stayed = np.isfinite(features).all(axis=-1)
    count = stayed.sum(axis=1).min()
    if count == 0 or count < LEAST * features.shape[1]:
        raise IntegrationError(
            f"{features.shape[1] - count} of {features.shape[1]} runs of a record diverged: a"
            " structure like this is thrown off"
        )
    return np.array([np.flatnonzero(row)[:count] for row in stayed])


def of_survivors(features):
    """Return (record, kept run, feature) of features (record, run, feature), see survivors."""
    return np.take_along_axis(features, survivors(features)[..., None], axis=1)
