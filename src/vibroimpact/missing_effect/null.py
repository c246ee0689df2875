"""What records look like where nothing is missing: the bare model with its nuisances drawn."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg, stats

from vibroimpact.discrepancy.covariance import feature_sd, free_directions, shrunk
from vibroimpact.discrepancy.divergence_filter import of_survivors
from vibroimpact.effects import gap
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.linear_stage.driven_channels import bursting, driven_channels
from vibroimpact.linear_stage.workbench import Workbench
from vibroimpact.observation.features import FeatureLayout, compressed

from . import constants
from .constants import CLEARANCE_SD
from .nuisances import clearance_draws, nuisance_draws
from .side_by_side import side_by_side


@dataclass(frozen=True)
class Null:
    """records (record,) that are compared; layout: FeatureLayout; mean (record, feature) of the
    model with its most probable nuisances; features (record, run, feature) of its runs with
    nuisances drawn, seeds_per_draw of each draw; free (record, feature, feature): covariance of
    what two right codes differ by; factor (record, feature, feature): Cholesky factors of the
    covariance of both about mean; measured (value,): the whitened difference of the measurement;
    groups (value,): whether the force drives the channel; along (direction, value) and rescaled
    (direction, direction): see effect_directions.told_of, none before effects are run.

    A value is a feature of a record in units of the covariance, all records in a row.
    """

    records: np.ndarray
    layout: FeatureLayout
    mean: np.ndarray
    features: np.ndarray
    seeds_per_draw: int
    free: np.ndarray
    factor: np.ndarray
    measured: np.ndarray
    groups: np.ndarray
    along: np.ndarray
    rescaled: np.ndarray

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

    @cached_property
    def deviations(self) -> np.ndarray:
        """Return (record, run, feature): what its own runs differ by from the mean, compressed."""
        return compressed(self.features - self.mean[:, None], self.layout)

    @property
    def drawn(self) -> np.ndarray:
        """Return (value,): what the mean of its own runs differs by from the mean."""
        return self.change(self.features.mean(axis=1))

    def change(self, features: np.ndarray) -> np.ndarray:
        """Return (value,): what features (record, feature) differ by from the mean."""
        whitened = [
            linalg.solve_triangular(factor, row, lower=True)
            for factor, row in zip(
                self.factor, compressed(features - self.mean, self.layout), strict=True
            )
        ]
        return self.in_units(np.concatenate(whitened))

    def in_units(self, change: np.ndarray) -> np.ndarray:
        """Return whitened changes (..., value) in units of what is known along effects."""
        inside = change @ self.along.T
        return change + (inside @ self.rescaled - inside) @ self.along

    def out_of_units(self, change: np.ndarray) -> np.ndarray:
        """Return whitened changes (..., value): in_units undone."""
        inside = change @ self.along.T
        return change + (np.linalg.solve(self.rescaled, inside.T).T - inside) @ self.along

    @property
    def plain(self) -> "Null":
        """Return this Null in units of its covariance alone, as before effects were run."""
        return replace(
            self,
            measured=self.out_of_units(self.measured),
            along=self.along[:0],
            rescaled=self.rescaled[:0, :0],
        )

    @property
    def chance(self) -> float:
        """Return the log likelihood of the measurement where nothing is missing, less that of a
        value in the middle of its law.
        """
        return float(-0.5 * self.measured @ self.measured)

    @property
    def differs(self) -> bool:
        """Return whether the measurement is farther off than chance allows: where it is not, no
        explanation is looked for. Covariances of few runs are too small along some directions,
        and there is always an effect that changes one of them.
        """
        return self.probability() < constants.CHANCE

    def probability(self, rest: np.ndarray | None = None) -> float:
        """Return how probable a measurement as far off a model as rest (value,) is by chance; as
        far off the null as it is where None.
        """
        rest = self.measured if rest is None else rest
        return float(stats.chi2.sf(rest @ rest, self.values))


def null_of(bench: Workbench, records: np.ndarray, seed: int, threads: int = 1) -> Null:
    """Return the Null of records of a Workbench; threads: runs at a time.

    Its mean is that of the most probable nuisances, with which explanations are run too. What
    drawn nuisances change on average is in the covariance: left in the mean, it is in the change
    of every explanation and in none of the measurement's.

    At the onset of contact a few percent of clearance decide whether a tube touches: clearances are
    drawn in the records that they change by more than chance, and in those alone. Where contact is
    strong a small scale is one of many effects alike.
    """
    draws = nuisance_draws(bench, constants.NULL_DRAWS, seed)
    seeds = max(1, LANES // len(records))
    benches = [bench] * -(-constants.MEAN_RUNS // seeds)
    benches += [bench.corrected_by(nuisance) for nuisance in draws]

    first = len(benches) - len(draws)  # of those with nuisances drawn

    def features(job):
        number, which, scale = job
        there, runs = benches[number], bench.runs(which, seeds, seed + seeds * number)
        scaled = None if scale == 1.0 else gap.apply(there.values, {"gap_factor": scale}, "all")
        return there.features(there.model(scaled), runs).reshape(len(which), seeds, -1)

    jobs = [(number, records, 1.0) for number in range(len(benches))]
    rows = side_by_side(features, jobs, threads)
    null = _of_rows(bench, records, rows, first)
    ends = [(0, records, float(np.exp(end))) for end in (-CLEARANCE_SD, CLEARANCE_SD)]
    near = at_onset(null, rows[0], side_by_side(features, ends, threads))
    if len(near):
        scales = enumerate(clearance_draws(len(draws), seed), start=first)
        jobs = [(number, records[near], scale) for number, scale in scales]
        for row, found in zip(rows[first:], side_by_side(features, jobs, threads), strict=True):
            row[near] = found
        null = _of_rows(bench, records, rows, first)
    return replace(null, measured=null.change(bench.measured_features[records]))


def at_onset(null: Null, features: np.ndarray, scaled: Sequence[np.ndarray]) -> np.ndarray:
    """Return the numbers of the records whose features (record, run, feature) one standard
    deviation of the clearances changes by more than chance; scaled: those of the same runs with
    clearances a standard deviation smaller, and larger.
    """
    at, *changed = (null.change(of_survivors(rows).mean(axis=1)) for rows in (features, *scaled))
    changes = np.array(changed) - at
    size = np.mean(changes.reshape(len(scaled), len(null.records), -1) ** 2, axis=-1)
    by_chance = 2.0 / features.shape[1]  # of what two means of so many runs differ by
    return np.flatnonzero(size.max(axis=0) > 1.0 + by_chance)


def scatter(rows: np.ndarray) -> np.ndarray:
    """Return the covariance (feature, feature) of deviations (run, feature) from the mean."""
    return shrunk(rows, len(rows))


def _of_rows(bench, records, rows, first):
    """Return the Null of features [(record, run, feature)], with nuisances drawn from the first."""
    central, drawn = (
        of_survivors(np.concatenate(part, axis=1)) for part in (rows[:first], rows[first:])
    )
    return _of_runs(bench, records, central, drawn)


def _of_runs(bench, records, central, drawn):
    """Return the Null, without its measurement, of features (record, run, feature): of the most
    probable nuisances, and of drawn ones.
    """
    layout, driven = bench.layout, driven_channels(bench)
    mean, common = central.mean(axis=1), free_directions(layout, driven)
    free, factors = [], []
    for middle, row, burst in zip(mean, drawn, bursting(bench, records, driven), strict=True):
        covariance = scatter(compressed(row - middle, layout))
        known = covariance / central.shape[1] + common.T @ common
        known += np.diag(feature_sd(layout) ** 2 + (burst * layout.blend) ** 2)
        free.append(known)
        factors.append(linalg.cholesky(covariance + known, lower=True))
    groups = np.tile(driven[layout.channel].astype(int), len(records))
    return Null(
        np.asarray(records),
        layout,
        mean,
        drawn,
        -(-drawn.shape[1] // constants.NULL_DRAWS),
        np.array(free),
        np.array(factors),
        np.zeros(0),
        groups,
        np.zeros((0, groups.size)),
        np.zeros((0, 0)),
    )
