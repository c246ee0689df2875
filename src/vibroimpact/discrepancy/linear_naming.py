"""Linear effects against the lowest record: each candidate's readings on a grid of its parameters, and the most probable parameters between."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import optimize
from scipy.interpolate import RegularGridInterpolator

from vibroimpact.config import check_config
from vibroimpact.discrepancy import nuisance as linear
from vibroimpact.discrepancy.attach import attach
from vibroimpact.discrepancy.linearised import linearised, same_modes
from vibroimpact.discrepancy.screening import NINETY

POINTS = {1: 7, 2: 5, 3: 4}  # of the grid along each parameter, by the number of parameters
NUISANCES = ("mode_frequency_error", "modal_damping")  # logarithms of readings are straight in their normalised parameters
STRAIGHT = 3
COARSE_MESH = {"elements_per_span": 8, "elements_per_bend": 32}
REACH = 6.0  # the reduced basis for readings reaches to so many times the excited band


@dataclass(frozen=True)
class LinearTable:
    """Readings of a candidate on a grid: axes of each parameter normalised from 0 to 1; values (..., reading) over the grid, of modes (mode,) and channels."""

    axes: tuple
    values: np.ndarray
    modes: np.ndarray
    channels: tuple

    def serves(self, bench):
        """Return whether the readings are of the modes and channels of a Workbench."""
        return np.array_equal(self.modes, bench.measured_fit.modes) and self.channels == tuple(bench.signals.names)

    @cached_property
    def _interpolator(self):
        return RegularGridInterpolator(self.axes, self.values, method="cubic" if min(len(axis) for axis in self.axes) > 3 else "linear")

    def reading(self, unit):
        """Return the Reading at normalised parameters (parameter,)."""
        row = self._interpolator(np.clip(unit, 0.0, 1.0)[None])[0]
        count = len(self.modes)
        return linear.Reading(self.modes, row[:count], row[count : 2 * count], row[2 * count :].reshape(-1, count), None)


def table_of(bench, candidate, scales):
    """Return the LinearTable of a linear effect of the model, modes as the measured fit has them."""
    config = coarse(bench.config, REACH * bench.signals.band_Hz[1])
    bare, modes = attach(config, bench.campaign), bench.measured_fit.modes
    reduced, values = same_modes(bare, modes, bench.bare), config.model_dump(mode="json")
    reference = linear.reading_of_model(bare, reduced)
    full = linear.reading_of_model(bench.bare, modes)
    count = STRAIGHT if candidate.effect_id in NUISANCES else POINTS[len(candidate.effect.parameters)]
    axes = tuple(np.linspace(0.0, 1.0, count) for _ in candidate.effect.parameters)
    rows = []
    for unit in np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1):
        variant = candidate.variant(values, candidate.physical(unit, scales))
        model = linearised(attach(check_config(variant, "variant of the model"), bench.campaign))
        found = linear.reading_of_model(model, same_modes(model, reduced, bare))
        # the reduced basis serves the change alone
        rows.append(np.concatenate([full.log_frequency + found.log_frequency - reference.log_frequency,
                                    full.log_damping + found.log_damping - reference.log_damping,
                                    (full.participation + found.participation - reference.participation).ravel()]))  # fmt: skip
    return LinearTable(axes, np.array(rows).reshape(*[count] * len(axes), -1), modes, tuple(bench.signals.names))


def coarse(config, highest_Hz):
    """Return the configuration with a coarse mesh and free modes alone, to a frequency in Hz: for changes of modes, not for modes."""
    basis = config.basis.model_copy(update={"free_modes_to_Hz": highest_Hz, "constrained_modes_to_Hz": 1.0, "attachment_shapes": False})
    structure = config.structure
    if hasattr(structure, "mesh"):
        structure = structure.model_copy(update={"mesh": structure.mesh.model_copy(update=COARSE_MESH)})
    return config.model_copy(update={"basis": basis, "structure": structure})


def reading_under(bench, candidate, unit, scales, table):
    """Return the Reading under a linear candidate at normalised parameters."""
    if not candidate.effect.measured:
        return replace(table.reading(unit), residual=np.ones(len(bench.signals.names)))
    bare = linear.reading_of_model(bench.bare, bench.measured_fit.modes)
    measuring = candidate.measuring(candidate.physical(unit, scales), bench.signals.names)
    return replace(bare, participation=bare.participation * (measuring.gain / measuring.force_gain)[:, None])


@dataclass(frozen=True)
class LinearResult:
    """The best of a candidate: unit (parameter,) normalised; gain of log likelihood over the bare model; interval (parameter, 2) of 90 %, normalised."""

    candidate: object
    unit: np.ndarray
    gain: float
    interval: np.ndarray


def calibrate(bench, candidate, scales, table=None):
    """Return the LinearResult of a linear candidate on the lowest record."""
    fit, measured = bench.measured_fit, bench.measured_reading
    bare = linear.likelihood(measured, linear.reading_of_model(bench.bare, fit.modes), fit.covariance)[0]

    def loss(unit):
        outside = np.sum(np.maximum(np.abs(np.asarray(unit) - 0.5) - 0.5, 0.0))
        reading = reading_under(bench, candidate, np.clip(unit, 0.0, 1.0), scales, table)
        return bare - linear.likelihood(measured, reading, fit.covariance)[0] + 1.0e3 * outside

    count = len(candidate.effect.parameters)
    axis = np.linspace(0.0, 1.0, {1: 61, 2: 15, 3: 7}[count])
    starts = np.stack([axes.ravel() for axes in np.meshgrid(*[axis] * count, indexing="ij")], axis=-1)
    losses = np.array([loss(unit) for unit in starts])
    found = optimize.minimize(loss, starts[np.argmin(losses)], method="Nelder-Mead", options={"xatol": 1.0e-4, "fatol": 1.0e-3, "maxiter": 200,
                              "initial_simplex": starts[np.argmin(losses)] + 0.05 * np.vstack([np.zeros(count), np.eye(count)])})  # fmt: skip
    unit = np.clip(found.x, 0.0, 1.0)
    chi_square = linear.likelihood(measured, reading_under(bench, candidate, unit, scales, table), fit.covariance)[1]
    left = max(1.0, chi_square / (2 * len(fit.modes) + fit.participation.size))  # what the effect does not explain widens its interval
    return LinearResult(candidate, unit, -float(found.fun), interval_of(loss, found.x, found.fun, NINETY * left))


def interval_of(loss, best, least, rise):
    """Return (parameter, 2): where the loss has risen by `rise` along each parameter, the others held; a bound where it never does."""
    out = np.zeros((len(best), 2))
    for number in range(len(best)):
        for side, end in ((0, 0.0), (1, 1.0)):
            def along(value, number=number):
                moved = np.array(best, float)
                moved[number] = value
                return loss(moved) - least - rise

            inside = float(np.clip(best[number], 0.0, 1.0))
            out[number, side] = optimize.brentq(along, inside, end, xtol=1.0e-4) if abs(end - inside) > 1.0e-9 and along(end) > 0.0 > along(inside) else end
    return out
