"""Linear models of a campaign: modes identified at its lowest level, again at each, and at all
together; and the places at which the structure changes with the level.

Places, relative displacements at which a law may act, are ranked by the misfit of a bilateral
support there, with one (k, c) per level, over all levels. Between two points with the relative
displacement w it exerts -(k w + c w'); at the lowest level k = c = 0. Modes, shapes and the (k, c)
of all levels are fitted together: frequencies and shapes that the support moves determine w better
than the small difference of two measured shapes. Source: the family of linear models of Thenint,
Balmes, Corus 2012, section 4.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.least_squares import minimise_by_differences
from vibroimpact.identify.modal_fit import Ridge, identify_modes, pack, refine_modes, unpack
from vibroimpact.identify.spectra.periodic_lines import LevelLines
from vibroimpact.reduction.modal_structure import IdentifiedModes

from .levels import naming_split
from .trial import Records, Trial

RESIDUALS = ((False, False), (True, False), (False, True), (True, True))
SIMPLE = 1.15  # times the least error: fewer residual modes within it are taken
PASSES = 12  # of the families that are ranked
GRID = 13  # stiffnesses tried at the start, per level
LOSSES = (0.0, 0.1, 0.3)  # loss factors tried with each
SUPPORT_RIDGE = 1.0e-4  # of the relative error, per support that moves a frequency by 1 %
MOST_TRIED = 3  # places at which every law is tried
NEAR = 4.0  # times the squared error of the best place: one above it is not tried


@dataclass(frozen=True, eq=False)
class LinearModels:
    """base: modes of the lowest fitted level. joint: of all levels that names are fitted to.
    again {name of a level: modes}: identified again at each.
    """

    base: IdentifiedModes
    joint: IdentifiedModes
    again: dict[str, IdentifiedModes]


def linear_models(
    levels: Sequence[LevelLines],
    sensors: tuple[Sequence[str], Sequence[str], int],
    band_Hz: Sequence[float],
    residuals: tuple[bool, bool] | None,
) -> LinearModels:
    """Return the LinearModels of levels in ascending load.

    sensors: kinds and names of the channels, number of the one at the force. residuals: modes
    (below, above) the band; None for the fewest that are needed. Raises ValueError if no pole is
    stable or levels are too few.
    """

    def identified(level: LevelLines, choice: tuple[bool, bool]) -> IdentifiedModes | ValueError:
        try:
            return identify_modes(level, band_Hz, *sensors, choice)[0]
        except ValueError as error:
            return error

    def error_of(modes: IdentifiedModes, level: LevelLines) -> float:
        return float(np.sqrt(np.mean(linear_errors(modes, level, band_Hz) ** 2)))

    named, _ = naming_split(levels)
    choices = RESIDUALS if residuals is None else (residuals,)
    tried = [identified(named[0], choice) for choice in choices]
    errors = [np.inf if isinstance(own, ValueError) else error_of(own, named[0]) for own in tried]
    number = next(at for at, error in enumerate(errors) if error <= SIMPLE * min(errors))
    base = tried[number]
    if isinstance(base, ValueError):
        raise base
    again = {}
    for level in levels:
        own = [refine_modes(base, [level], band_Hz), identified(level, choices[number])]
        known = {error_of(each, level): each for each in own if isinstance(each, IdentifiedModes)}
        again[level.name] = known[min(known)]
    return LinearModels(base, refine_modes(base, named, band_Hz), again)


def linear_errors(
    modes: IdentifiedModes, level: LevelLines, band_Hz: Sequence[float]
) -> np.ndarray:
    """Return (channel,) relative error of the linear response at a level, at the excited lines."""
    return Records((level,), band_Hz).errors(Trial(modes))[0]


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
        """Return (line,) relative displacement per unit force of the drive at a level, Hz."""
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

    Raises ValueError if none is left.
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
    """Return the stiffness in N/m that moves the frequency of the mode with most of a relative
    displacement (mode,) by 1 %.
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
    given, records, ridge = pack(modes), Records(levels, band_Hz), Ridge(modes)
    unit, rate = stiffness_unit(modes, modes.shapes @ row), np.pi * (band_Hz[0] + band_Hz[1])

    def support(values: np.ndarray) -> np.ndarray:
        """Return (2, level): the k and c of values, in units of both."""
        return np.pad(values[given.size :].reshape(2, -1), ((0, 0), (1, 0)))

    def missed(values: np.ndarray) -> list[np.ndarray]:
        trial, predicted = unpack(values, modes), []
        along, rows = trial.shapes @ row, zip(levels, records.lines, *support(values), strict=True)
        for level, lines, k, c in rows:
            frequency = level.frequency[lines]
            driven, own = _views(trial, along, frequency)
            stiffness = k * unit + 2j * np.pi * frequency * c * unit / rate
            back = trial.frf(frequency, along) * stiffness * driven / (1.0 + stiffness * own)
            predicted.append((trial.frf(frequency) - back) * level.force[lines])
        return records.missed(predicted)

    def error_of(values: np.ndarray) -> np.ndarray:
        flat = np.concatenate([each.ravel() for each in missed(values)])
        held = SUPPORT_RIDGE * values[given.size :]
        return np.concatenate([flat.real, flat.imag, ridge.error(values), held])

    sizes = np.outer(np.geomspace(0.05, 20.0, GRID), (1.0, -1.0)).ravel()
    pairs = np.array([(size, loss * abs(size)) for size in sizes for loss in LOSSES])
    tried = [missed(np.concatenate([given, np.repeat(pair, len(levels) - 1)])) for pair in pairs]
    costs = np.array([[np.sum(np.abs(each) ** 2) for each in own[1:]] for own in tried])
    start = np.concatenate([given, pairs[np.argmin(costs, axis=0)].T.ravel()])
    steps, size = np.full(start.size, 1.0e-5), np.mean(modes.shapes[~modes.residual] ** 2)
    steps[2 * modes.modes : given.size] = 1.0e-4 * np.sqrt(size)
    found = minimise_by_differences(error_of, start, steps, passes).values
    k, c = support(found) * unit
    errors = np.array([np.linalg.norm(each, axis=1) for each in missed(found)])
    return Family(unpack(found, modes), row, k, c / rate, errors)


def _views(
    modes: IdentifiedModes, along: np.ndarray, frequency: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return (relative displacement per force of the drive (line,), per unit pair of forces at the
    support (line,)).
    """
    receptance = modes.receptance(frequency)
    return (along * modes.shapes[:, modes.drive]) @ receptance, (along**2) @ receptance
