"""What the map of disagreement needs of missing_effect.null.Null, a package above this one."""

from typing import Protocol

import numpy as np


class NullLike(Protocol):
    """The features of records where no effect is missing, as in missing_effect.null.Null."""

    @property
    def records(self) -> np.ndarray:
        """(record,) indices of the records compared."""

    @property
    def mean(self) -> np.ndarray:
        """(record, feature)."""

    @property
    def covariance(self) -> np.ndarray:
        """(record, feature, feature)."""

    @property
    def seed_variance(self) -> np.ndarray:
        """(record, feature), of one run."""

    @property
    def seeds(self) -> int:
        """Number of runs of every record."""
