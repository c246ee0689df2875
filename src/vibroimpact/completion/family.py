"""The paper's idea on a measured structure: a family of linear models, identified modes with a
bilateral support (k, c) of its own per level.

Between two points with the relative displacement w = b . q the support exerts -(k w + c w'); at the
reference level k = c = 0, so that k and c are changes of the equivalent stiffness and damping of
what joins the points. Modes, shapes and the (k, c) of all levels are fitted together: frequencies
and shapes that the support moves then tell more of b than the small difference of two measured
shapes.
"""

from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.modal_fit import Ridge, channel_scale, pack, unpack
from vibroimpact.least_squares import differences, minimise
from vibroimpact.reduction.modal_structure import IdentifiedModes

GRID = 13  # stiffnesses tried at the start, per level
SUPPORT_RIDGE = 1.0e-4  # of the relative error, per support that moves a frequency by 1 %
LOSSES = (0.0, 0.1, 0.3)  # loss factors tried with each


@dataclass(frozen=True, eq=False)
class Family:
    """modes: IdentifiedModes at the reference level; row (channel,): the relative displacement; k
    (level,) N/m and c (level,) N s/m: changes against the reference level, in the order of the
    levels it was fitted to; reference: its index; errors (level, channel) relative; covariance (2
    level, 2 level) of (k, c) in turn, from the residual's scatter.
    """

    modes: IdentifiedModes
    row: np.ndarray
    k: np.ndarray
    c: np.ndarray
    reference: int
    errors: np.ndarray
    covariance: np.ndarray

    def frf(self, frequency, k, c):
        """Return (channel, line) response per unit force of the drive with a support (k N/m, c N
        s/m).
        """
        return family_frf(self.modes, self.modes.shapes @ self.row, frequency, k, c)

    def motion(self, frequency, k, c):
        """Return (line,) relative displacement per unit force of the drive."""
        driven, own = _views(self.modes, self.modes.shapes @ self.row, frequency)
        return driven / (1.0 + (k + 2j * np.pi * frequency * c) * own)


def _views(modes, along, frequency):
    """(relative displacement per force of the drive (line,), per unit pair of forces at the support
    (line,)).
    """
    receptance = modes.receptance(frequency)
    return (along * modes.shapes[:, modes.drive]) @ receptance, (along**2) @ receptance


def family_frf(modes, along, frequency, k, c):
    """Return (channel, line) response per unit force of modes with a support (k N/m, c N s/m) along
    a relative displacement (mode,).
    """
    driven, own = _views(modes, along, frequency)
    support = k + 2j * np.pi * frequency * c
    return modes.frf(frequency) - modes.frf(frequency, along) * (
        support * driven / (1.0 + support * own)
    )


def fit_family(modes, row, levels, band_Hz, reference=0, passes=60):
    """Return the Family fitted to LevelLines, from the IdentifiedModes of the level `reference`."""
    row = np.asarray(row, float)
    grids = [level.frequency[level.excited(band_Hz)] for level in levels]
    scales = [channel_scale(level, band_Hz) for level in levels]
    forces = [level.force[level.excited(band_Hz)] for level in levels]
    wanted = [
        level.response[:, level.excited(band_Hz)] / scale
        for level, scale in zip(levels, scales, strict=True)
    ]
    unit = _stiffness_unit(modes, row)
    rate = np.pi * (band_Hz[0] + band_Hz[1])
    ridge, count = Ridge(modes), pack(modes).size
    others = [index for index in range(len(levels)) if index != reference]

    def missed(trial, index, k, c):
        lines = (
            family_frf(trial, trial.shapes @ row, grids[index], k * unit, c * unit / rate)
            * forces[index]
        )
        return (lines / scales[index] - wanted[index]).ravel()

    def support(values):
        k, c = np.zeros(len(levels)), np.zeros(len(levels))
        k[others], c[others] = values[count:].reshape(2, -1)
        return k, c

    def error_of(values):
        trial, (k, c) = unpack(values, modes), support(values)
        parts = np.concatenate(
            [missed(trial, index, k[index], c[index]) for index in range(len(levels))]
        )
        return np.concatenate(
            [parts.real, parts.imag, ridge.error(values), SUPPORT_RIDGE * values[count:]]
        )

    def evaluate(values):
        error = error_of(values)
        steps = np.full(values.size, 1.0e-5)
        steps[2 * modes.modes : count] = 1.0e-4 * np.sqrt(
            np.mean(modes.shapes[~modes.residual] ** 2)
        )
        return error, differences(error_of, values, error, steps)

    start = np.array([_best_support(missed, modes, index) for index in others]).reshape(-1, 2)
    found = minimise(evaluate, np.concatenate([pack(modes), start[:, 0], start[:, 1]]), passes)
    trial, (k, c) = unpack(found.values, modes), support(found.values)
    errors = np.array(
        [
            np.sqrt(
                np.sum(
                    np.abs(missed(trial, index, k[index], c[index]).reshape(len(scale), -1)) ** 2,
                    axis=1,
                )
            )
            for index, scale in enumerate(scales)
        ]
    )
    covariance = (
        np.linalg.pinv(found.slope.T @ found.slope)
        * found.cost
        / max(found.error.size - found.values.size, 1)
    )
    spread = np.diag(np.tile([unit, unit / rate], len(levels)))
    own = np.zeros((2 * len(levels), 2 * len(levels)))
    places = np.concatenate(
        [[2 * index for index in others], [2 * index + 1 for index in others]]
    ).astype(int)
    own[np.ix_(places, places)] = covariance[count:, count:]
    return Family(trial, row, k * unit, c * unit / rate, reference, errors, spread @ own @ spread)


def _stiffness_unit(modes, row):
    """Return N/m: the support that would move the frequency of the mode with most relative motion
    by 1 %.
    """
    along = modes.shapes @ row
    own = ~modes.residual & (along != 0.0)
    return float(np.min(0.02 * modes.omega[own] ** 2 / along[own] ** 2))


def _best_support(missed, modes, index):
    """Return (k, c) in units: the one of a grid with the least error at a level, the modes held."""
    sizes = np.geomspace(0.05, 20.0, GRID)
    tried = [
        (sign * size, loss * size) for size in sizes for sign in (1.0, -1.0) for loss in LOSSES
    ]
    costs = [np.sum(np.abs(missed(modes, index, *pair)) ** 2) for pair in tried]
    return tried[int(np.argmin(costs))]
