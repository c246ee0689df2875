"""Discard diverged runs: a measured structure did not diverge."""

import numpy as np

from vibroimpact.integration.contact_convergence import IntegrationError

LEAST = 0.5  # share of the runs of every record that must remain


def survivors(features: np.ndarray) -> np.ndarray:
    """Return (record, kept run) the indices of the finite runs, the same number for every record.

    features: (record, run, feature). Raises IntegrationError where fewer than half of a record's
    runs are finite.
    """
    stayed = np.isfinite(features).all(axis=-1)
    count = stayed.sum(axis=1).min()
    if count == 0 or count < LEAST * features.shape[1]:
        raise IntegrationError(
            f"{features.shape[1] - count} of {features.shape[1]} runs of a record diverged: a"
            " structure like this is thrown off"
        )
    return np.array([np.flatnonzero(row)[:count] for row in stayed])


def of_survivors(features: np.ndarray) -> np.ndarray:
    """Return (record, kept run, feature) of features (record, run, feature), see survivors."""
    return np.take_along_axis(features, survivors(features)[..., None], axis=1)
