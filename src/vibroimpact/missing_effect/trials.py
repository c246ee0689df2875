"""Runs of one explanation, and what they tell of it between the points that were run."""

from dataclasses import dataclass, field

import numpy as np
from scipy import linalg

from . import constants


@dataclass
class Trial:
    """An explanation and its runs: candidate; unit (run, parameter) from 0 to 1; change (run,
    value) and noise (run,): variance of a value of it; failed: [(unit, sentence)];
    screened: how many of the runs, the first, are of the stretch that is screened.
    """

    candidate: object
    unit: np.ndarray
    change: np.ndarray
    noise: np.ndarray
    failed: list = field(default_factory=list)
    screened: int = 0

    @property
    def refined(self):
        """Return the number of runs beside those of the stretch that is screened."""
        return len(self.noise) - self.screened

    @classmethod
    def empty(cls, candidate, values):
        """Return the Trial of a candidate without runs."""
        return cls(
            candidate,
            np.zeros((0, len(candidate.effect.parameters))),
            np.zeros((0, values)),
            np.zeros(0),
        )

    def add(self, unit, change, noise):
        """Add a run."""
        self.unit = np.vstack([self.unit, unit])
        self.change = np.vstack([self.change, change])
        self.noise = np.append(self.noise, noise)


class Emulator:
    """The change (value,) at any parameters, by a Gaussian process along the leading directions of
    the runs of a Trial; neutral (parameter,): where nothing changes, None: far from all runs the
    change is their mean then, 0 where it is not centred.

    directions (direction, value) are orthonormal.
    """

    def __init__(self, trial, neutral=None, centred=True):
        unit, change, noise = trial.unit, trial.change, trial.noise
        self.periodic = list(trial.candidate.periodic)
        _, size, directions = linalg.svd(change, full_matrices=False)
        signal = size**2 / len(change) - noise.mean()
        kept = signal > 0.5 * noise.mean()
        kept[0] = True
        self.directions = directions[kept]
        self.signal = np.maximum(signal[kept], 0.1 * noise.mean())
        known = change @ self.directions.T
        self.centre = np.zeros(len(self.signal))
        if neutral is None and centred:
            self.centre = np.average(known, axis=0, weights=1.0 / noise)
        elif neutral is not None:
            unit = np.vstack([unit, neutral])
            known = np.vstack([known, np.zeros(known.shape[1])])
            noise = np.append(noise, 0.01 * noise.min())
        self.unit = unit
        fits = [
            max(
                (self._fit(number, row, noise, length) for length in constants.LENGTHS),
                key=lambda found: found[0],
            )
            for number, row in enumerate((known - self.centre).T)
        ]
        _, self.lengths, self.solved, self.inverse = zip(*fits, strict=True)

    def _kernel(self, one, other, length):
        distance = one[:, None] - other[None]
        for number in self.periodic:
            distance[..., number] = np.sin(np.pi * distance[..., number]) / np.pi
        return np.exp(-0.5 * np.sum(distance**2, axis=-1) / length**2)

    def _fit(self, number, known, noise, length):
        """Return (log likelihood, length, solved (run,), inverse (run, run)) of a direction."""
        kernel = 2.0 * self.signal[number] * self._kernel(self.unit, self.unit, length)
        factor = linalg.cholesky(kernel + np.diag(noise + 1.0e-6 * self.signal[number]), lower=True)
        solved = linalg.cho_solve((factor, True), known)
        chance = -0.5 * known @ solved - np.log(np.diag(factor)).sum()
        return chance, length, solved, linalg.cho_solve((factor, True), np.eye(len(known)))

    def __call__(self, unit):
        """Return (mean, variance), (point, direction) each, at unit (point, parameter)."""
        unit, mean, variance = np.atleast_2d(unit), [], []
        for number, signal in enumerate(self.signal):
            against = 2.0 * signal * self._kernel(unit, self.unit, self.lengths[number])
            mean.append(self.centre[number] + against @ self.solved[number])
            told = np.sum((against @ self.inverse[number]) * against, axis=1)
            variance.append(np.maximum(2.0 * signal - told, 0.0))
        return np.array(mean).T, np.array(variance).T


class PairEmulator:
    """The change of two effects at once: the sum of what each changes alone, and what runs of both
    differ from it by; first, second: Emulators; trial: of the pair; split: number of the first
    one's parameters.
    """

    def __init__(self, trial, first, second, split):
        self.first, self.second, self.split = first, second, split
        sum_ = np.array([self._sum(unit) for unit in trial.unit])
        self.rest = Emulator(
            Trial(trial.candidate, trial.unit, trial.change - sum_, trial.noise), centred=False
        )
        self.directions = np.vstack([first.directions, second.directions, self.rest.directions])

    def _sum(self, unit):
        return sum(
            (emulator(part)[0][0] @ emulator.directions)
            for emulator, part in (
                (self.first, unit[: self.split]),
                (self.second, unit[self.split :]),
            )
        )

    def __call__(self, unit):
        """Return (mean, variance), (point, direction) each, at unit (point, parameter)."""
        unit = np.atleast_2d(unit)
        rows = [
            self.first(unit[:, : self.split]),
            self.second(unit[:, self.split :]),
            self.rest(unit),
        ]
        # where both were run, what each alone leaves open is known
        open_ = np.clip(rows[2][1].sum(axis=1) / (2.0 * self.rest.signal.sum()), 0.0, 1.0)
        variances = [rows[0][1] * open_[:, None], rows[1][1] * open_[:, None], rows[2][1]]
        return np.hstack([mean for mean, _ in rows]), np.hstack(variances)
