"""Modes identified from a campaign: at its lowest level, again at each, and at all together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from vibroimpact.identify.modal_fit import identify_modes, refine_modes, relative_errors
from vibroimpact.reduction.modal_structure import IdentifiedModes
from vibroimpact.spectra.periodic_lines import LevelLines

from .levels import naming_split

RESIDUALS = ((False, False), (True, False), (False, True), (True, True))
SIMPLE = 1.15  # times the least error: fewer residual modes within it are taken


@dataclass(frozen=True)
class Sensors:
    """names, kinds (channel,); drive: index of the channel at the force."""

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    drive: int


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
    sensors: Sensors,
    band_Hz: Sequence[float],
    residuals: tuple[bool, bool] | None,
) -> LinearModels:
    """Return the LinearModels of levels in ascending load.

    residuals: modes (below, above) the band; None for the fewest that are needed. Raises ValueError
    where no pole is stable.
    """
    lowest = next(level for level in levels if level.split == "fit")
    choices = RESIDUALS if residuals is None else (residuals,)
    tried = [_identified(lowest, sensors, band_Hz, choice) for choice in choices]
    found = [each for each in tried if isinstance(each, IdentifiedModes)]
    if not found:
        raise tried[0]
    errors = [_rms(modes, lowest, band_Hz) for modes in found]
    number = next(at for at, error in enumerate(errors) if error <= SIMPLE * min(errors))
    base = found[number]
    kept = choices[tried.index(base)]
    again = {}
    for level in levels:
        own = [refine_modes(base, [level], band_Hz), _identified(level, sensors, band_Hz, kept)]
        known = [modes for modes in own if isinstance(modes, IdentifiedModes)]
        again[level.name] = min(known, key=partial(_rms, level=level, band_Hz=band_Hz))
    return LinearModels(base, refine_modes(base, naming_split(levels)[0], band_Hz), again)


def linear_errors(
    modes: IdentifiedModes, level: LevelLines, band_Hz: Sequence[float]
) -> np.ndarray:
    """Return (channel,) relative error of the linear response at a level, at the excited lines."""
    lines = level.excited(band_Hz)
    return relative_errors(modes.frf(level.frequency[lines]) * level.force[lines], level, band_Hz)


def _identified(level, sensors, band_Hz, residuals):
    """Return the modes of a level, or the ValueError that says why there are none."""
    try:
        return identify_modes(
            level, band_Hz, sensors.kinds, sensors.names, sensors.drive, residuals
        )[0]
    except ValueError as error:
        return error


def _rms(modes, level, band_Hz):
    """Return the RMS over channels of linear_errors."""
    return float(np.sqrt(np.mean(linear_errors(modes, level, band_Hz) ** 2)))
