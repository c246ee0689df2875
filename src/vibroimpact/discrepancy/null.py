"""The null: what the bare model, corrected for nuisances, does on the campaign's forces from seed
to seed, and what two codes of it may differ by.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from . import priors
from .features import compressed
from .likelihood import feature_sd, free_directions, log_likelihood, scatter_of, shrunk
from .linearised import same_modes
from .sensed import motion_there
from .survivors import of_survivors

UNSEEN = (
    priors.UNSEEN_DAMPING,
    1.0 / priors.UNSEEN_DAMPING,
)  # times the damping of modes that the lowest record does not show
# of the covariance: what a model's runs scatter by more than the null's along a direction counts
# from there; below it, it is that of few runs
SCATTERED = 0.5
LEAST_RUNS = 4  # that a scatter is told from


@dataclass(frozen=True)
class Null:
    """records (record,) of the campaign; features (record, seed, feature); mean (record, feature);
    covariance (record, feature, feature) of one record about the mean, with what two codes differ
    by, and apart (record, feature, feature) the same without what other damping of unseen modes
    changes; groups (feature,): channels that the force drives, or does not; blend (feature,): see
    features.compressed.
    """

    records: np.ndarray
    features: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray
    apart: np.ndarray
    groups: np.ndarray
    blend: np.ndarray

    @property
    def seed_variance(self):
        """Return (record, feature): the variance of one seed."""
        return self.features.var(axis=1, ddof=1)

    @property
    def seeds(self):
        """Return the number of seeds."""
        return self.features.shape[1]

    def left_out(self):
        """Return (record, seed): the chi-square of each seed under the others, with what two codes
        differ by.
        """
        out = np.empty(self.features.shape[:2])
        for record, seed in np.ndindex(out.shape):
            own, others = self.features[record], np.delete(self.features[record], seed, axis=0)
            known, left = (scatter_of(rows, self) for rows in (own, others))
            covariance = (
                self.covariance[record]
                - (1.0 + 1.0 / len(own)) * known.covariance
                + (1.0 + 1.0 / len(others)) * left.covariance
            )
            out[record, seed] = log_likelihood(compressed(own[seed] - left.mean, self), covariance)[
                1
            ]
        return out

    def freed(self, directions):
        """Return the Null with directions (direction, record, compressed feature) left free, one
        sigma each, in place of its own; itself where there are none.
        """
        return (
            replace(self, covariance=self.apart + np.einsum("drf,drg->rfg", directions, directions))
            if len(directions)
            else self
        )

    def scattered(self, rows):
        """Return the Null with the scatter of a model's own runs, rows (record, run, compressed
        feature) of deviations, along directions in which it is clearly larger; as it is where there
        are too few.

        A soft contact, or one near the onset of motion across the force, is thrown about more than
        the bare model's: what one run is off by is no more than that.
        """
        if rows.shape[1] < LEAST_RUNS:
            return self
        own = [scatter_of(features, self).covariance for features in self.features]
        return replace(
            self,
            covariance=np.array(
                [
                    _wider(*row)
                    for row in zip(
                        self.covariance, map(shrunk, rows, map(len, rows)), own, strict=True
                    )
                ]
            ),
        )


def _wider(covariance, here, there):
    """Return covariance (feature, feature) and what `here` has more than `there`, along directions
    in which that is more than SCATTERED of it.
    """
    factor = linalg.cholesky(covariance, lower=True)
    white = linalg.solve_triangular(
        factor, linalg.solve_triangular(factor, here - there, lower=True).T, lower=True
    )
    more, along = linalg.eigh(0.5 * (white + white.T))
    along = factor @ along[:, more > SCATTERED]
    return covariance + (along * more[more > SCATTERED]) @ along.T


def unseen_damping(bench, values, factor):
    """Return the model of a configuration in plain values with another damping of the structure's
    modes that the lowest record does not tell of.
    """
    model = bench.model(values)
    plates = [
        np.sqrt(support["plate"]["stiffness_N_per_m"] / support["plate"]["mass_kg"])
        for support in values["supports"]
        if support.get("plate")
    ]
    unseen = ~np.isin(model.omega, plates)
    if bench.linear_stage and bench.modes_told:
        unseen[same_modes(model, bench.measured_fit.modes, bench.bare)] = False
    return replace(model, damping=np.where(unseen, factor, 1.0) * model.damping)


def null_of(bench, records, features, *others):
    """Return the Null of (record, seed, feature) of the bare model and of others, the same with
    less and with more damping of unseen modes.
    """
    driven = driven_channels(bench)
    common, own = free_directions(bench.layout, driven), np.diag(feature_sd(bench.layout) ** 2)
    means, apart, bursts = [], [], bursting(bench, records, driven)
    for nominal, burst in zip(features, bursts, strict=True):
        scatter = scatter_of(nominal, bench.layout)
        means.append(scatter.mean)
        apart.append(
            scatter.covariance * (1.0 + 1.0 / len(nominal))
            + own
            + np.diag((burst * bench.layout.blend) ** 2)
            + common.T @ common
        )
    means, apart = np.array(means), np.array(apart)
    directions = np.array(
        [compressed(other.mean(axis=1) - means, bench.layout) for other in others]
    )
    return Null(
        np.asarray(records),
        features,
        means,
        apart,
        apart,
        driven[bench.layout.channel].astype(int),
        bench.layout.blend,
    ).freed(directions)


def bursting(bench, records, driven):
    """Return (record, feature) bool: features of channels that the force does not drive and whose
    measured record is a few bursts over noise.

    Motion across the force is an instability: whether and when it breaks out for a moment is no
    property that two codes of one tube share, and the power of the record is that of the moment.
    Such features tell no more than to within features.BLEND.
    """
    layout, measured = bench.layout, bench.measured_features[records]
    peaked = measured[:, layout.kind == "kurtosis"] > priors.BURST
    return (peaked & ~driven)[:, layout.channel]


def driven_channels(bench):
    """Return (channel,): whether the linear structure answers to a force there; a contact force,
    whether it does at its support.
    """
    shapes, drive = motion_there(bench.bare, bench.signals.kinds), np.abs(bench.bare.drive_shapes)
    size = (np.abs(shapes)[:, :, None] * drive[:, None, :]).max(axis=(0, 2))
    return size > 1.0e-3 * size.max()


def free_at(bench, candidate, unit, scales, records, first_seed):
    """Return (1, record, compressed feature): half of what less and more damping of unseen modes
    differ by at normalised parameters (parameter,) of a candidate, times sqrt(2): the two
    directions that the null has apart, as one of their common size.

    By runs of its own: against a point of the candidate's path, the scatter of that point's few
    seeds would be free as well, and it alone would look right. Whether motion across the force
    breaks out in a record, and when, hangs on that damping near the onset, and the onset moves with
    the candidate: at a clearance 1.72 times the nominal one 10 N are at it, at the nominal one far
    beyond.
    """
    physical, seeds = candidate.physical(unit, scales), bench.seeds_of_a_batch(records)
    values = bench.variant(candidate, physical)
    measuring = candidate.measuring(physical, bench.signals.names)
    runs = bench.runs(records, seeds, first_seed)
    less, more = (
        of_survivors(
            bench.features(unseen_damping(bench, values, factor), runs, measuring).reshape(
                len(records), seeds, -1
            )
        ).mean(axis=1)
        for factor in UNSEEN
    )
    return compressed(less - more, bench.layout)[None] / np.sqrt(2.0)
