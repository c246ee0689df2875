"""The best step of the nuisances beside a change of the model, by their columns at a base.

Nuisances that were fitted without an effect take on some of it: common gains stand for a gap,
frequencies for a mass. At their values the effect alone gains little. So whatever is compared with
a base is compared at nuisances of its own, to first order and without a run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from .bench import Bench, misfit, whitening
from .coordinates import Coordinate, bounds, to_vector
from .explanations import Point
from .gauss_newton import linearised, products


@dataclass(frozen=True, eq=False)
class Nuisances:
    """The nuisances about a base Point on the stretches of a Bench.

    lines (stretch, channel, line): of the base. columns (nuisance, stretch, channel, line): their
    derivatives by the nuisances `rows`, whose priors have the size one.
    """

    bench: Bench
    base: Point
    rows: tuple[Coordinate, ...]
    lines: np.ndarray
    columns: np.ndarray

    def on(self, stretches: slice) -> Nuisances:
        """Return the Nuisances on some of the stretches."""
        bench, lines = self.bench.on(stretches), self.lines[stretches]
        return replace(self, bench=bench, lines=lines, columns=self.columns[:, stretches])

    @cached_property
    def now(self) -> float:
        """Return the objective of the base."""
        return self.objective(self.lines, self.base)

    def objective(self, lines: np.ndarray, point: Point) -> float:
        """Return the misfit of the lines (stretch, channel, line) of a Point and the prior of its
        nuisances, after their best step; infinite if a run failed.
        """
        if not np.isfinite(lines).all():
            return np.inf
        x = to_vector(point, self.rows)
        pull = products(self._white, (lines * self._weight).ravel())
        step = -np.linalg.solve(self._normal + np.eye(len(x)), pull + x)
        return min(self._value(lines, x, 0.0 * x), self._value(lines, x, step))

    def best_step(self, derivative: np.ndarray, farthest: float) -> np.ndarray:
        """Return (coordinate + nuisance,) the best step of coordinates of an effect, no longer than
        `farthest`, and of the nuisances beside it.

        derivative (coordinate, stretch, channel, line): of the lines of the base.
        """
        count, x = len(derivative), to_vector(self.base, self.rows)
        own = (derivative * self._weight).reshape(count, -1)
        cross = products(own, self._white)
        normal = np.block([[products(own, own), cross], [cross.T, self._normal]])
        held = np.r_[np.full(count, farthest**-2.0), np.ones(len(x))]
        pull = products(np.concatenate([own, self._white]), (self.lines * self._weight).ravel())
        step = -np.linalg.solve(normal + np.diag(held), pull + np.r_[np.zeros(count), x])
        return step / max(1.0, np.abs(step[:count]).max(initial=0.0) / farthest)

    @cached_property
    def _weight(self) -> np.ndarray:
        """Return (stretch, channel, line): see bench.whitening."""
        return whitening(self.bench, self.lines)

    @cached_property
    def _white(self) -> np.ndarray:
        """Return (nuisance, all lines): whitened columns."""
        return (self.columns * self._weight).reshape(len(self.rows), -1)

    @cached_property
    def _normal(self) -> np.ndarray:
        """Return (nuisance, nuisance) of the whitened columns."""
        return products(self._white, self._white)

    def _value(self, lines: np.ndarray, x: np.ndarray, step: np.ndarray) -> float:
        """Return the objective of lines after a step from nuisances x."""
        step = np.clip(x + step, *bounds(self.rows)) - x
        moved = lines + np.tensordot(step, self.columns, 1)
        return misfit(self.bench, moved) + 0.5 * float(np.sum((x + step) ** 2))


def nuisances_at(bench: Bench, base: Point, rows: Sequence[Coordinate]) -> Nuisances:
    """Return the Nuisances about a Point, whose columns are found by runs."""
    return Nuisances(bench, base, tuple(rows), *linearised(bench, base, rows))
