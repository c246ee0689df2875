"""Where a structure changes with the level: the relative displacements at which a law may act,
ranked by how well a bilateral support (k, c) of its own per level explains all levels.

Between two points with the relative displacement w the support exerts -(k w + c w'); at the lowest
level k = c = 0. Modes, shapes and the (k, c) of all levels are fitted together: frequencies and
shapes that the support moves tell more of w than the small difference of two measured shapes.
Source: the family of linear models of Thenint, Balmes, Corus 2012, section 4.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.modal_fit import Ridge, channel_scale, pack, unpack
from vibroimpact.least_squares import differences, minimise
from vibroimpact.reduction.modal_structure import IdentifiedModes
from vibroimpact.spectra.periodic_lines import LevelLines

PASSES = 12
GRID = 13  # stiffnesses tried at the start, per level
LOSSES = (0.0, 0.1, 0.3)  # loss factors tried with each
SUPPORT_RIDGE = 1.0e-4  # of the relative error, per support that moves a frequency by 1 %
MOST_TRIED = 3  # places at which every law is tried
NEAR = 4.0  # times the squared error of the best place: one above it is not tried


@dataclass(frozen=True, eq=False)
class Family:
    """Linear models with a support at one place.

    modes: at the lowest level. row (channel,): the relative displacement. k, c (level,): N/m and
    N s/m, changes against the lowest level. errors (level, channel): relative.
    """

    modes: IdentifiedModes
    row: np.ndarray
    k: np.ndarray
    c: np.ndarray
    errors: np.ndarray

    @property
    def error(self) -> float:
        """Return the RMS of errors."""
        return float(np.sqrt(np.mean(self.errors**2)))

    def motion(self, level: int, frequency: np.ndarray) -> np.ndarray:
        """Return (line,) relative displacement per unit force of the drive at a level."""
        driven, own = _views(self.modes, self.modes.shapes @ self.row, frequency)
        return driven / (1.0 + (self.k[level] + 2j * np.pi * frequency * self.c[level]) * own)


def row_of(row: Mapping[str, float], names: Sequence[str]) -> np.ndarray:
    """Return (channel,) the coefficients of a place {channel: coefficient} over channels."""
    return np.array([float(row.get(name, 0.0)) for name in names])


def ranked_places(
    places: Mapping[str, Mapping[str, float]],
    base: IdentifiedModes,
    levels: Sequence[LevelLines],
    band_Hz: Sequence[float],
) -> dict[str, Family]:
    """Return {place: Family}, the best first; places that no mode moves are left out.

    Raises ValueError where none is left.
    """
    rows = {place: row_of(row, base.names) for place, row in places.items()}
    families = {
        place: fit_family(base, row, levels, band_Hz, PASSES)
        for place, row in rows.items()
        if np.any(base.shapes[~base.residual] @ row)
    }
    if not families:
        raise ValueError("no mode moves any of the places: give others")
    return dict(sorted(families.items(), key=lambda item: item[1].error))


def tried_places(ranking: Mapping[str, Family]) -> list[str]:
    """Return the places at which laws are tried: the best, and others hardly worse."""
    best = next(iter(ranking.values())).error
    near = [place for place, family in ranking.items() if family.error**2 <= NEAR * best**2]
    return near[:MOST_TRIED]


def stiffness_unit(modes: IdentifiedModes, along: np.ndarray) -> float:
    """Return N/m: what would move the frequency of the mode with most of a relative displacement
    (mode,) by 1 %.
    """
    own = ~modes.residual & (along != 0.0)
    return float(np.min(0.02 * modes.omega[own] ** 2 / along[own] ** 2))


def fit_family(
    modes: IdentifiedModes,
    row: np.ndarray,
    levels: Sequence[LevelLines],
    band_Hz: Sequence[float],
    passes: int = 60,
) -> Family:
    """Return the Family fitted to levels, from the modes of the first one."""
    count, others = pack(modes).size, len(levels) - 1
    unit, rate = stiffness_unit(modes, modes.shapes @ row), np.pi * (band_Hz[0] + band_Hz[1])
    lines = [level.excited(band_Hz) for level in levels]
    scales = [channel_scale(level, band_Hz) for level in levels]
    ridge = Ridge(modes)

    def missed(trial, index, k, c):
        level, own = levels[index], lines[index]
        frequency = level.frequency[own]
        driven, alone = _views(trial, trial.shapes @ row, frequency)
        support = k * unit + 2j * np.pi * frequency * c * unit / rate
        back = trial.frf(frequency, trial.shapes @ row) * support * driven / (1 + support * alone)
        response = (trial.frf(frequency) - back) * level.force[own]
        return (response - level.response[:, own]) / scales[index]

    def parts(values):
        k, c = np.zeros((2, others + 1))
        k[1:], c[1:] = values[count:].reshape(2, -1)
        trial = unpack(values, modes)
        return [missed(trial, index, k[index], c[index]) for index in range(others + 1)]

    def error_of(values):
        flat = np.concatenate([part.ravel() for part in parts(values)])
        held = SUPPORT_RIDGE * values[count:]
        return np.concatenate([flat.real, flat.imag, ridge.error(values), held])

    steps = np.full(count + 2 * others, 1.0e-5)
    steps[2 * modes.modes : count] = 1.0e-4 * np.sqrt(np.mean(modes.shapes[~modes.residual] ** 2))

    def evaluate(values):
        error = error_of(values)
        return error, differences(error_of, values, error, steps)

    def best_support(index):
        sizes = np.outer(np.geomspace(0.05, 20.0, GRID), (1.0, -1.0)).ravel()
        tried = [(size, loss * abs(size)) for size in sizes for loss in LOSSES]
        return min(tried, key=lambda pair: np.sum(np.abs(missed(modes, index, *pair)) ** 2))

    start = np.array([best_support(index) for index in range(1, others + 1)]).reshape(-1, 2)
    found = minimise(evaluate, np.concatenate([pack(modes), start.T.ravel()]), passes).values
    k, c = np.concatenate([np.zeros((2, 1)), found[count:].reshape(2, -1)], axis=1) * unit
    errors = np.array([np.linalg.norm(part, axis=1) for part in parts(found)])
    return Family(unpack(found, modes), row, k, c / rate, errors)


def _views(modes, along, frequency):
    """Return (relative displacement per force of the drive (line,), per unit pair of forces at the
    support (line,)).
    """
    receptance = modes.receptance(frequency)
    return (along * modes.shapes[:, modes.drive]) @ receptance, (along**2) @ receptance
