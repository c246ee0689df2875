"""The steady response of an identified structure as the free runs of any diagnosis."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..free_runs import SEEDS, FreeRuns
from .trial import Records, Trial

SEED = 7  # of the noise
PERIODS_BEFORE = 4  # the period that is compared: the transient is gone


def steady_lines(trial: Trial, records: Records) -> list[np.ndarray]:
    """Return [(channel, line)] of the excited lines of every level.

    Raises ValueError where the model has no bounded motion at some level.
    """
    lines = records.predict(trial, PERIODS_BEFORE)
    if lines is None:
        raise ValueError(
            f"{trial.name}: the completed model has no bounded motion at some level that it was not"
            " fitted to: leave that level out."
        )
    rows = zip(lines, records.levels, strict=True)
    return [own[:, level.frequency[records.kept(level)] > 0.0] for own, level in rows]


def free_runs(before: Trial, after: Trial, records: Records) -> FreeRuns:
    """Return the FreeRuns of two trials, at the excited lines of the lowest level.

    The measured scatter between periods is drawn for each of SEEDS runs: their distance is the
    floor. Levels with other lines are interpolated.
    """
    levels = records.levels
    inside = [level.excited(records.band_Hz) for level in levels]
    grids = [level.frequency[own] for level, own in zip(levels, inside, strict=True)]
    scatter = [
        np.nan_to_num(level.noise[:, own]) for level, own in zip(levels, inside, strict=True)
    ]
    draw = np.random.default_rng(SEED)

    def psd(values: Sequence[np.ndarray]) -> np.ndarray:
        """Return (record, channel, line): one-sided PSD of complex amplitudes."""
        rows = zip(values, grids, levels, strict=True)
        power = [(grid, 2.0 * np.abs(own) ** 2 / level.frequency[1]) for own, grid, level in rows]
        return np.array([[np.interp(grids[0], grid, row) for row in own] for grid, own in power])

    def noisy(own: np.ndarray, size: np.ndarray) -> np.ndarray:
        real, imaginary = draw.standard_normal((2, *own.shape)) / np.sqrt(2.0)
        return own + size * (real + 1j * imaginary)

    def runs(trial: Trial) -> np.ndarray:
        """Return (record, seed, channel, line) of a trial."""
        rows = list(zip(steady_lines(trial, records), scatter, strict=True))
        return np.stack([psd([noisy(*row) for row in rows]) for _ in range(SEEDS)], axis=1)

    first = runs(before)
    last = first if after is before else runs(after)
    measured = [level.response[:, own] for level, own in zip(levels, inside, strict=True)]
    return FreeRuns(grids[0], psd(measured), first, last, psd(scatter).mean(axis=(0, 2)))
