"""What effects change, as directions, and what chance and another right code change along them."""

from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from vibroimpact.discrepancy.covariance import shrunk

from . import constants
from .null import Null, scatter


@dataclass(frozen=True)
class EffectDirections:
    """along (direction, value): orthonormal; share (direction,): of the variance of what effects
    change, each scaled to one size, the most first.
    """

    along: np.ndarray
    share: np.ndarray

    @classmethod
    def of(
        cls, changes: np.ndarray, noise: np.ndarray, null: Null, weight: np.ndarray | None = None
    ) -> "EffectDirections":
        """Return the EffectDirections of changes (run, value) with noise (run,), the variance of a
        value; a change that is not seen has none. weight (run,): how much each counts, all alike
        where None.

        Changes are counted from the mean of the null's drawn runs. Its mean is of a few runs, and
        what it is off by is in every change and in the measurement: were it a direction, every
        explanation would take it away.
        """
        changes = changes - null.drawn
        told = seen(changes, noise)
        weight = np.ones(len(noise)) if weight is None else weight
        weight = weight[told] / max(weight[told].sum(), 1.0e-300)
        whole = np.sum(changes[told] ** 2, axis=1)
        unit = changes[told] * np.sqrt(weight / whole)[:, None]
        scattered = np.sum(weight**2 * noise[told] * null.values / whole)
        _, singular, along = linalg.svd(unit, full_matrices=False)
        # the largest singular value of scatter alone (Marchenko and Pastur 1967)
        largest = scattered * (1.0 + np.sqrt(max(len(unit), 1) / null.values)) ** 2
        kept = singular**2 > largest
        along, share = along[kept], singular[kept] ** 2 - scattered
        return cls(along, share / max(share.sum(), 1.0e-12))


TOLD = 3.0  # standard deviations of the scatter of its own that a change must exceed


def seen(changes: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Return (run,) bool: whether changes (run, value) can be told from their own scatter, noise
    (run,): variance of a value.
    """
    values = changes.shape[1]
    size = np.sum(changes**2, axis=1) - noise * values
    return size > constants.SEEN + TOLD * noise * np.sqrt(2.0 * values)


def told_of(null: Null, effects: EffectDirections) -> Null:
    """Return a Null whose values have unit variance along the directions of effects too: that of
    its own runs, each left out of the covariance that it is measured by, and what two right codes
    differ by.

    A covariance of a few runs is too large along most directions and too small along some, and
    nuisances are the same in all records, which a covariance of each record does not know.
    """
    if not len(effects.share):
        return null
    rows = left_out(null, effects.along)
    alike = constants.ALIKE**2 * null.values * effects.share
    covariance = shrunk(rows, len(rows)) + along_of(null, effects.along) + np.diag(alike)
    size, turn = linalg.eigh(covariance)
    root = turn @ np.diag(1.0 / np.sqrt(size)) @ turn.T
    told = replace(null, along=effects.along, rescaled=root)
    return replace(told, measured=told.in_units(null.measured))


def left_out(null: Null, along: np.ndarray) -> np.ndarray:
    """Return (run, direction): runs of the null along directions, in units of the covariance of the
    runs of all other draws of nuisances.
    """
    deviations, free = null.deviations, null.free
    draw = np.arange(null.seeds) // null.seeds_per_draw
    out = np.zeros((null.seeds, len(along)))
    parts = np.split(along, len(null.records), axis=1)
    for number in np.unique(draw):
        own = draw == number
        inner, told = np.zeros((len(along), len(along))), np.zeros((own.sum(), len(along)))
        for row, known, factor, part in zip(deviations, free, null.factor, parts, strict=True):
            other = linalg.cholesky(scatter(row[~own]) + known, lower=True)
            turned = linalg.solve_triangular(other, factor @ part.T, lower=True)
            rest = linalg.solve_triangular(other, row[own].T, lower=True)
            inner += turned.T @ turned
            told += rest.T @ turned
        size, turn = linalg.eigh(inner)
        out[own] = told @ (turn / np.sqrt(size)) @ turn.T
    return out


def along_of(null: Null, along: np.ndarray) -> np.ndarray:
    """Return (direction, direction): the covariance of what two right codes differ by."""
    out = np.zeros((len(along), len(along)))
    for free, factor, part in zip(
        null.free, null.factor, np.split(along, len(null.records), axis=1), strict=True
    ):
        turned = linalg.solve_triangular(factor, part.T, lower=True, trans="T")
        out += turned.T @ free @ turned
    return out
