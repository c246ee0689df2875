"""Linear effects fitted to the lowest record by tables: each candidate's readings on a grid of its
parameters, and the most probable parameters by interpolation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import optimize
from scipy.interpolate import RegularGridInterpolator

from . import nuisance as linear
from .candidates import Candidate, unit_grid
from .effect_fit import LinearChanges, LinearResult
from .workbench import Workbench

POINTS = {1: 7, 2: 5, 3: 4}  # of the grid along each parameter, by the number of parameters
# logarithms of readings are linear in the normalised parameters of these; points of their grids
NUISANCES = ("mode_frequency_error", "modal_damping")
STRAIGHT = 3
NINETY = 1.353  # of log likelihood below the best: the interval of 90 % of a normal law


@dataclass(frozen=True)
class LinearTable:
    """Readings of a candidate on a grid.

    axes: of each parameter, normalised from 0 to 1. values (..., reading): over the grid.
    modes (mode,), channels: what the readings are of.
    """

    axes: tuple[np.ndarray, ...]
    values: np.ndarray
    modes: np.ndarray
    channels: tuple[str, ...]

    def serves(self, bench: Workbench) -> bool:
        """Return whether the readings are of the modes and channels of a Workbench."""
        return np.array_equal(self.modes, bench.measured_fit.modes) and self.channels == tuple(
            bench.signals.names
        )

    @cached_property
    def _interpolator(self):
        return RegularGridInterpolator(
            self.axes,
            self.values,
            method="cubic" if min(len(axis) for axis in self.axes) > 3 else "linear",
        )

    def reading(self, unit: np.ndarray) -> linear.Reading:
        """Return the Reading at normalised parameters (parameter,)."""
        row = self._interpolator(np.clip(unit, 0.0, 1.0)[None])[0]
        count = len(self.modes)
        return linear.Reading(
            self.modes,
            row[:count],
            row[count : 2 * count],
            row[2 * count :].reshape(-1, count),
            np.ones(len(self.channels)),
        )


def table_of(
    bench: Workbench, candidate: Candidate, scales: dict[str, float], changes: LinearChanges
) -> LinearTable:
    """Return the LinearTable of a linear effect of the model, of the modes of the measured fit;
    changes: LinearChanges of the Workbench.
    """
    count = (
        STRAIGHT if candidate.effect_id in NUISANCES else POINTS[len(candidate.effect.parameters)]
    )
    axes, rows = (np.linspace(0.0, 1.0, count),) * len(candidate.effect.parameters), []
    for unit in unit_grid(len(axes), count):
        found = changes.reading(candidate, candidate.physical(unit, scales))
        rows.append(
            np.concatenate([found.log_frequency, found.log_damping, found.participation.ravel()])
        )
    return LinearTable(
        axes,
        np.array(rows).reshape(*[count] * len(axes), -1),
        changes.modes,
        tuple(bench.signals.names),
    )


def reading_under(
    bench: Workbench,
    candidate: Candidate,
    unit: np.ndarray,
    scales: dict[str, float],
    table: LinearTable | None,
) -> linear.Reading:
    """Return the Reading that a linear candidate at normalised parameters predicts; table: its
    LinearTable, None for a fault of the measuring chain.
    """
    if not candidate.effect.measured:
        assert table is not None, "an effect of the model has a table"
        return table.reading(unit)
    return linear.gained(
        linear.reading_of_model(bench.bare, bench.measured_fit.modes),
        candidate.measuring(candidate.physical(unit, scales), bench.signals.names),
    )


def calibrate(
    bench: Workbench,
    candidate: Candidate,
    scales: dict[str, float],
    table: LinearTable | None = None,
) -> LinearResult[Candidate]:
    """Return the LinearResult of a linear candidate on the lowest record; table: see
    reading_under.
    """
    fit, measured = bench.measured_fit, bench.measured_reading
    start = linear.reading_of_model(bench.bare, fit.modes)
    bare = linear.likelihood(measured, start)[0]

    def loss(unit):
        outside = np.sum(np.maximum(np.abs(np.asarray(unit) - 0.5) - 0.5, 0.0))
        reading = reading_under(bench, candidate, np.clip(unit, 0.0, 1.0), scales, table)
        return bare - linear.likelihood(measured, reading, start)[0] + 1.0e3 * outside

    count = len(candidate.effect.parameters)
    starts = unit_grid(count, {1: 61, 2: 15, 3: 7}[count])
    losses = np.array([loss(unit) for unit in starts])
    found = optimize.minimize(
        loss,
        starts[np.argmin(losses)],
        method="Nelder-Mead",
        options={
            "xatol": 1.0e-4,
            "fatol": 1.0e-3,
            "maxiter": 200,
            "initial_simplex": (
                starts[np.argmin(losses)] + 0.05 * np.vstack([np.zeros(count), np.eye(count)])
            ),
        },
    )
    unit = np.clip(found.x, 0.0, 1.0)
    chi_square = linear.likelihood(
        measured, reading_under(bench, candidate, unit, scales, table), start
    )[1]
    # a misfit beyond chance widens the interval
    left = max(1.0, chi_square / (2 * len(fit.modes) + fit.participation.size))
    return LinearResult(
        candidate, unit, -float(found.fun), interval_of(loss, found.x, found.fun, NINETY * left)
    )


def interval_of(
    loss: Callable[[np.ndarray], float], best: np.ndarray, least: float, rise: float
) -> np.ndarray:
    """Return (parameter, 2): where the loss exceeds the least by `rise` along each parameter, the
    others fixed at the best; a bound where it never does.
    """
    out = np.zeros((len(best), 2))
    for number in range(len(best)):
        for side, end in ((0, 0.0), (1, 1.0)):

            def along(value, number=number):
                moved = np.array(best, float)
                moved[number] = value
                return loss(moved) - least - rise

            inside = float(np.clip(best[number], 0.0, 1.0))
            out[number, side] = (
                optimize.brentq(along, inside, end, xtol=1.0e-4)
                if abs(end - inside) > 1.0e-9 and along(end) > 0.0 > along(inside)
                else end
            )
    return out
