"""Runs of one explanation, and what they tell of it between the points that were run."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy import linalg

from vibroimpact.linear_stage.candidates import Candidate, Pair

from . import constants
from .effect_directions import EffectDirections

LEAST_SIGNAL = 0.1  # of the scatter: no change is known to be less
NEGLIGIBLE = 1.0e-3  # of what the runs change: directions below it are left out
SUPPOSED = 5.0  # seeds, of the variance of the null, that are supposed beside those run


@dataclass
class Trial:
    """An explanation and its runs: candidate; unit (run, parameter) from 0 to 1; change (run,
    value) and noise (run,): variance of a value of it; deviations [(seed, value)]: what the seeds
    of a run differ by from their mean, none of a single seed; failed: [(unit, sentence)];
    screened: how many of the runs, the first, were placed without regard to the measurement;
    strewn: how many later ones.
    """

    candidate: Candidate | Pair
    unit: np.ndarray
    change: np.ndarray
    noise: np.ndarray
    deviations: list = field(default_factory=list)
    failed: list = field(default_factory=list)
    screened: int = 0
    strewn: int = 0

    @property
    def tried(self) -> list[np.ndarray]:
        """Return the points, those that could not be run too."""
        return [*self.unit, *(unit for unit, _ in self.failed)]

    @property
    def refined(self) -> int:
        """Return the number of runs that were placed by what is known."""
        return len(self.noise) - self.screened - self.strewn

    @classmethod
    def empty(cls, candidate: Candidate | Pair, values: int) -> "Trial":
        """Return the Trial of a candidate without runs."""
        return cls(
            candidate,
            np.zeros((0, len(candidate.effect.parameters))),
            np.zeros((0, values)),
            np.zeros(0),
        )

    def drawn_in(self, size: float) -> "Trial":
        """Return the Trial with larger changes made so large: were they left as they are, how far a
        run tells would be learned from where no answer can be.
        """
        share = np.minimum(1.0, size / np.maximum(np.linalg.norm(self.change, axis=1), 1.0e-12))
        return replace(self, change=self.change * share[:, None], noise=self.noise * share**2)

    def add(self, unit: np.ndarray, changes: np.ndarray) -> None:
        """Add a run of changes (seed, value)."""
        seeds, mean = len(changes), changes.mean(axis=0)
        deviations = (changes - mean)[: seeds if seeds > 1 else 0]
        noise = np.sum(deviations**2) / ((seeds - 1) * mean.size) if seeds > 1 else 1.0
        self.unit = np.vstack([self.unit, unit])
        self.change = np.vstack([self.change, mean])
        self.noise = np.append(self.noise, noise / seeds)
        self.deviations.append(deviations)

    def scatter(self, along: np.ndarray, weight: np.ndarray) -> np.ndarray:
        """Return (direction,): the variance of a single seed along orthonormal directions
        (direction, value), of runs with weight (run,).

        Hard or sticking contact may scatter several times as much as the null along what it
        changes.
        """
        return self._pooled(
            [np.sum((row @ along.T) ** 2, axis=0) for row in self.deviations], weight
        )

    def scatter_of_all(self, weight: np.ndarray) -> float:
        """Return the same, the mean of all values."""
        return float(
            self._pooled([np.mean(np.sum(row**2, axis=0)) for row in self.deviations], weight)
        )

    def _pooled(self, squares, weight):
        """Return a variance of sums of squares [of each run], pooled with what is supposed."""
        free = np.array([max(len(row) - 1, 0) for row in self.deviations])
        known = sum(share * row for share, row in zip(weight, squares, strict=True))
        return (SUPPOSED + known) / (SUPPOSED + weight @ free)


class Emulator:
    """The change (value,) at any parameters, by a Gaussian process that all values share, of the
    lengths that make the runs most likely; neutral (..., parameter): where nothing changes, None:
    far from all runs the change is their mean then, 0 where it is not centred; looked:
    EffectDirections along which runs are known, None: along all.

    directions (direction, value) are orthonormal: those that the runs, smoothed, lie along; excess
    (direction,): by how much more than the null a measurement scatters along them; run (run,
    parameter): where it was run. answer (value,): what is looked for, None: nothing; runs near it
    count more for what is learned.
    """

    def __init__(
        self,
        trial: Trial,
        neutral: np.ndarray | None = None,
        looked: EffectDirections | None = None,
        centred: bool = True,
        answer: np.ndarray | None = None,
    ) -> None:
        unit, self.looked = trial.unit, looked
        change = trial.change if looked is None else trial.change @ looked.along.T
        if answer is not None:
            answer = answer if looked is None else answer @ looked.along.T
        self.run = unit
        self.periodic = list(trial.candidate.periodic)
        scatter = trial.noise * change.shape[1]
        counts = _nearness(change, scatter, answer)
        if looked is not None:
            own = trial.scatter(looked.along, counts)
            scatter = scatter * own.mean() / trial.scatter_of_all(counts)
        centre = np.zeros(change.shape[1])
        if neutral is not None:
            neutral = np.atleast_2d(neutral)
            unit = np.vstack([unit, neutral])
            change = np.vstack([change, np.zeros((len(neutral), change.shape[1]))])
            scatter = np.append(scatter, np.full(len(neutral), 0.01 * scatter.min()))
        elif centred:
            centre = np.average(change, axis=0, weights=1.0 / scatter)
        size = np.sum(change**2, axis=1) - scatter
        self.size = max(float(size.mean()), float(scatter.mean()) * LEAST_SIGNAL)
        self.unit, self.ratio = unit, scatter / self.size + 1.0e-6
        near = np.argsort(-_nearness(change, scatter, answer), kind="stable")
        self._learn(change - centre, near[: 2 * constants.FEW_RUNS * unit.shape[1]])
        smooth = self._kernel(unit, unit) @ self.inverse @ (change - centre) + centre
        _, sizes, directions = linalg.svd(smooth, full_matrices=False)
        kept = sizes**2 > NEGLIGIBLE * np.sum(sizes**2)
        self.centre = directions[kept] @ centre
        self.solved = self.inverse @ (change - centre) @ directions[kept].T
        self.directions: np.ndarray = (
            directions[kept] if looked is None else directions[kept] @ looked.along
        )
        self.signal = self.size * sizes[kept] ** 2 / np.sum(sizes[kept] ** 2)
        self.excess = np.maximum(trial.scatter(self.directions, counts) - 1.0, 0.0)

    def _learn(self, change, near):
        """Take the length along each parameter that makes the runs near the answer, of numbers near
        (run,), most likely (Rasmussen and Williams 2006, chapter 5): a resonance turns within a
        twentieth of a range along which a mass does little. Of few runs, a short one for all: they
        tell of no length, and a long one would tell of all that was not run.
        """
        count = self.unit.shape[1]
        known = len(change) >= constants.FEW_RUNS * count
        apart = 0.5 * count / len(change)  # shorter ones would tell of nothing between the runs
        tried = [length for length in constants.LENGTHS if length > apart]
        if not known:
            tried = list(constants.FEW_LENGTHS)
        rows = [np.full(count, length) for length in tried]
        best = min(rows, key=lambda row: self._unlikely(row, change, near))
        for number in range(count if known and count > 1 else 0):
            rows = [np.where(np.arange(count) == number, length, best) for length in tried]
            best = min(rows, key=lambda row: self._unlikely(row, change, near))
        self.length = best
        self.inverse = linalg.inv(self._kernel(self.unit, self.unit) + np.diag(self.ratio))

    def _unlikely(self, length, change, near):
        """Return how unlikely changes (run, value) of some of the runs are with length
        (parameter,): -2 log likelihood of one of as many directions as they lie along.
        """
        self.length = length
        unit, change = self.unit[near], change[near]
        covariance = self._kernel(unit, unit) + np.diag(self.ratio[near])
        square = float(np.sum(change * np.linalg.solve(covariance, change)))
        return square / self.size + np.linalg.slogdet(covariance)[1]

    def _kernel(self, one, other):
        distance = one[:, None] - other[None]
        for number in self.periodic:
            distance[..., number] = np.sin(np.pi * distance[..., number]) / np.pi
        return np.exp(-0.5 * np.sum((distance / self.length) ** 2, axis=-1))

    def __call__(self, unit: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (mean, variance), (point, direction) each, at unit (point, parameter)."""
        against = self._kernel(np.atleast_2d(unit), self.unit)
        return self.centre + against @ self.solved, self._unknown(against) * self.signal

    def _unknown(self, against):
        """Return (point, 1): the share of variance that a kernel (point, run) leaves unknown."""
        told = np.sum((against @ self.inverse) * against, axis=1)
        return np.clip(1.0 - told, 0.0, None)[:, None]

    def open_along(
        self, unit: np.ndarray, directions: np.ndarray, variance: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return (directions (direction, value), variance (point, direction)): along what the
        change at unit (point, parameter) may lie, given its variance along known directions.

        Few runs do not show all directions that an explanation has: a share of what is not known
        lies along those of all effects.
        """
        if self.looked is None:
            return directions, variance
        unknown = self._unknown(self._kernel(np.atleast_2d(unit), self.unit))
        new = self.size / (1.0 + len(self.run)) * self.looked.share
        turned = (directions @ self.looked.along.T) ** 2
        return self.looked.along, variance @ turned + unknown * new


def _nearness(change, scatter, answer):
    """Return (run,): 1 of the run of changes (run, value) nearest to an answer (value,), less of
    others, by their distance; 1 of all where it is None.
    """
    if answer is None:
        return np.ones(len(change))
    away = np.sqrt(np.sum((change - answer) ** 2, axis=1) + scatter)
    return away.min() / away


class PairEmulator:
    """The change of two effects at once: the sum of what each changes alone, and what runs of both
    differ from it by; first, second: Emulators; trial: of the pair; looked: see Emulator.
    """

    def __init__(
        self,
        trial: Trial,
        first: "AnyEmulator",
        second: "AnyEmulator",
        looked: EffectDirections | None = None,
    ) -> None:
        self.first, self.second, self.run = first, second, trial.unit
        self.split = first.run.shape[1]
        sum_ = np.array([self._sum(unit) for unit in trial.unit])
        self.rest = Emulator(
            replace(trial, change=trial.change - sum_),
            looked=looked,
            centred=False,
        )
        parts = (first, second, self.rest)
        self.directions: np.ndarray = np.vstack([part.directions for part in parts])
        own = np.zeros(len(self.rest.directions))  # it scatters as its parts do
        self.excess: np.ndarray = np.concatenate([first.excess, second.excess, own])

    def _sum(self, unit):
        return sum(
            (emulator(part)[0][0] @ emulator.directions)
            for emulator, part in (
                (self.first, unit[: self.split]),
                (self.second, unit[self.split :]),
            )
        )

    def __call__(self, unit: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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

    def open_along(
        self, unit: np.ndarray, directions: np.ndarray, variance: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the same as Emulator.open_along: of what both together add to their sum."""
        return self.rest.open_along(unit, directions, variance)


AnyEmulator = Emulator | PairEmulator
