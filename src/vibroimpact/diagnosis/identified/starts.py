"""Where the fit of a law begins: values and modes, or drawn participations of a hidden place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vibroimpact.reduction.modal_structure import IdentifiedModes

from .local_laws import Scales
from .modes import LinearModels
from .places import Family, stiffness_unit
from .trial import LocalTerm, Records, Trial

FREE_STARTS = 6  # drawn participations of a place that no channel shows
FREE_VALUES = 2  # start values tried with each
SEED = 2012


def alone(term: LocalTerm, family: Family, linear: LinearModels, records: Records) -> list[Trial]:
    """Return [Trial]: the start of a law by itself, the best of its start values on the modes of
    the lowest level, of the place's family, or of all levels; empty where none is bounded.

    term: without values. family: of its place, fitted to the levels of the records.
    """
    motion = [
        _rms(family.motion(index, frequency) * force)
        for index, (frequency, force) in enumerate(_driven(records))
    ]
    omega, along = _middle(records), family.modes.shapes @ family.row
    # a quarter of what, taken away, would leave the structure without any stiffness there
    softest = float(0.25 / np.sum(along**2 / family.modes.omega**2))
    strength = min(float(np.max(np.abs(family.k + 1j * omega * family.c))), softest)
    values = term.effect.starts(Scales(strength, min(motion), max(motion), omega))
    return _best(
        [
            Trial(modes, (replace(term, values=own),))
            for modes in (linear.base, family.modes, linear.joint)
            for own in values
        ],
        records,
    )


def beside(known: Trial, term: LocalTerm, linear: LinearModels, records: Records) -> list[Trial]:
    """Return [Trial]: starts of a law beside fitted ones, on their modes and on those of the lowest
    level, or, at a place that no channel shows, with drawn participations.

    Which of them leads further shows after a few passes only. term: without values.
    """
    bare = [(term, modes) for modes in (known.modes, linear.base)]
    if term.row is None:
        bare = [(replace(term, participation=own), known.modes) for own in _drawn(known.modes)]
    out = []
    for own, modes in bare:
        values = term.effect.starts(_scales(known.modes, records, own.along(known.modes)))
        some = values if term.row is not None else values[:FREE_VALUES]
        out += _best([known.beside(replace(own, values=each), modes) for each in some], records)
    return out


def _scales(modes: IdentifiedModes, records: Records, along: np.ndarray) -> Scales:
    """Return the Scales of a relative displacement per unit modal amplitude (mode,)."""
    driven = along * modes.shapes[:, modes.drive]
    motion = [
        _rms(driven @ modes.receptance(frequency) * force) for frequency, force in _driven(records)
    ]
    return Scales(stiffness_unit(modes, along), min(motion), max(motion), _middle(records))


def _drawn(modes: IdentifiedModes) -> list[np.ndarray]:
    """Return [(mode,)] of either sign, in proportion to the frequency: a spring there makes the
    same relative change of every frequency.
    """
    drawn = np.random.default_rng(SEED)
    size = np.where(modes.residual, 0.0, modes.omega / np.median(modes.omega))
    return [size * drawn.choice([-1.0, 1.0], size.size) for _ in range(FREE_STARTS)]


def _best(trials: Sequence[Trial], records: Records) -> list[Trial]:
    """Return [the trial with the least squared error], empty where none has a bounded motion."""
    costs = [records.cost(records.predict(trial)) for trial in trials]
    return [trials[int(np.argmin(costs))]] if np.isfinite(min(costs)) else []


def _driven(records: Records) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return [(frequency, force)] of the excited lines of every level."""
    rows = [(level, level.excited(records.band_Hz)) for level in records.levels]
    return [(level.frequency[lines], level.force[lines]) for level, lines in rows]


def _rms(lines: np.ndarray) -> float:
    """Return the RMS of a signal of complex amplitudes (line,)."""
    return float(np.sqrt(2.0 * np.sum(np.abs(lines) ** 2)))


def _middle(records: Records) -> float:
    """Return the angular frequency in rad/s below which half of the power of the last level's
    response lies, all channels together.
    """
    level = records.levels[-1]
    lines = np.flatnonzero(level.excited(records.band_Hz))
    power = np.cumsum(np.sum(np.abs(level.response[:, lines]) ** 2, axis=0))
    return float(2.0 * np.pi * level.frequency[lines[np.searchsorted(power, 0.5 * power[-1])]])
