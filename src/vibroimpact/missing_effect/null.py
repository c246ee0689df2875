"""What records look like where nothing is missing: the bare model with its nuisances drawn."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg, stats

from vibroimpact.discrepancy.covariance import feature_sd, free_directions, shrunk
from vibroimpact.discrepancy.driven import bursting, driven_channels
from vibroimpact.discrepancy.features import FeatureLayout, compressed
from vibroimpact.discrepancy.survivors import of_survivors
from vibroimpact.discrepancy.workbench import Workbench
from vibroimpact.integration.kernels.lanes import LANES

from . import constants
from .nuisances import nuisance_draws


@dataclass(frozen=True)
class Null:
    """records (record,) that are compared; layout: FeatureLayout; features (record, run, feature)
    of the model's runs; factor (record, feature, feature): Cholesky factors of the covariance of a
    record about their mean; measured (value,): the whitened difference of the measurement from it;
    groups (value,): whether the force drives the channel; alike (direction, value): what two right
    codes differ by along the changes of effects, one sigma each, none before screening.

    A value is a feature of a record in units of the covariance, all records in a row.
    """

    records: np.ndarray
    layout: FeatureLayout
    features: np.ndarray
    factor: np.ndarray
    measured: np.ndarray
    groups: np.ndarray
    alike: np.ndarray

    @cached_property
    def mean(self) -> np.ndarray:
        """Return (record, feature)."""
        return self.features.mean(axis=1)

    @property
    def covariance(self) -> np.ndarray:
        """Return (record, feature, feature)."""
        return self.factor @ self.factor.transpose(0, 2, 1)

    @property
    def seed_variance(self) -> np.ndarray:
        """Return (record, feature): the variance of one run."""
        return self.features.var(axis=1, ddof=1)

    @property
    def seeds(self) -> int:
        """Return the number of runs of every record."""
        return self.features.shape[1]

    @property
    def values(self) -> int:
        """Return the number of values."""
        return self.measured.size

    def change(self, features: np.ndarray) -> np.ndarray:
        """Return (value,): what features (record, feature) differ by from the mean."""
        return np.concatenate(
            [
                linalg.solve_triangular(factor, row, lower=True)
                for factor, row in zip(
                    self.factor, compressed(features - self.mean, self.layout), strict=True
                )
            ]
        )

    @cached_property
    def chance(self) -> float:
        """Return the log likelihood of the measurement where nothing is missing, less that of a
        value in the middle of its law.
        """
        inner = np.eye(len(self.alike)) + self.alike @ self.alike.T
        along = self.alike @ self.measured
        square = self.measured @ self.measured - along @ np.linalg.solve(inner, along)
        return float(-0.5 * (square + np.linalg.slogdet(inner)[1]))

    def probability(self, rest: np.ndarray | None = None) -> float:
        """Return how probable a measurement as far off a model as rest (value,) is by chance; as
        far off the null as it is where None.
        """
        rest = self.measured if rest is None else rest
        return float(stats.chi2.sf(rest @ rest, self.values))


def null_of(bench: Workbench, records: np.ndarray, seed: int) -> Null:
    """Return the Null of records of a Workbench."""
    seeds = max(1, LANES // len(records))
    rows = []
    for number, nuisance in enumerate(nuisance_draws(bench, constants.NULL_DRAWS, seed)):
        there = bench.corrected_by(nuisance)
        runs = bench.runs(records, seeds, seed + seeds * number)
        rows.append(there.features(there.model(), runs).reshape(len(records), seeds, -1))
    null = _scatter(bench, records, of_survivors(np.concatenate(rows, axis=1)))
    return replace(null, measured=null.change(bench.measured_features[records]))


def _scatter(bench, records, features):
    """Return the Null of features (record, run, feature) without its measurement."""
    layout, driven = bench.layout, driven_channels(bench)
    count, common = features.shape[1], free_directions(layout, driven)
    factors = []
    for row, burst in zip(features, bursting(bench, records, driven), strict=True):
        covariance = shrunk(compressed(row - row.mean(axis=0), layout), count - 1)
        covariance = covariance * (1.0 + 1.0 / count) + common.T @ common
        covariance += np.diag(feature_sd(layout) ** 2 + (burst * layout.blend) ** 2)
        factors.append(linalg.cholesky(covariance, lower=True))
    groups = np.tile(driven[layout.channel].astype(int), len(records))
    return Null(
        np.asarray(records),
        layout,
        features,
        np.array(factors),
        np.zeros(0),
        groups,
        np.zeros((0, groups.size)),
    )
