"""The search: what was run of every explanation, and what its runs say."""

import traceback
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import logsumexp

from vibroimpact.config.reading import ConfigError
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.linear_stage.candidates import Candidate, Pair, candidate_named
from vibroimpact.linear_stage.workbench import Workbench
from vibroimpact.run_cost import SIMULATED

from .effect_directions import EffectDirections, seen, told_of
from .evidence import SomethingElse, fit
from .first_points import first_points
from .null import Null
from .parameters import estimate
from .side_by_side import side_by_side
from .trials import AnyEmulator, Emulator, PairEmulator, Trial

IN_PROGRAM = "an error of the program, to be reported, with its traceback in the log"

Row = tuple[str, np.ndarray]  # an explanation's name, units (point, parameter)


@dataclass
class Search:
    """A Workbench of what is compared, its Null, and all Trials so far {name: Trial} with their
    Fits {name: Fit}. looked: see learn; None: all that runs change is known. threads: runs at a
    time; most: time steps of modes beyond which nothing more is run; before: those that were
    counted before the search; ended: those that were run when something was not run for it, 0
    where all was.
    """

    bench: Workbench
    null: Null
    scales: dict
    trials: dict = field(default_factory=dict)
    fits: dict = field(default_factory=dict)
    seed: int = 1000
    looked: EffectDirections | None = None
    threads: int = 1
    most: float = np.inf
    before: int = field(default_factory=lambda: SIMULATED["steps"])
    ended: int = 0

    @property
    def ran(self) -> int:
        """Return how many time steps of modes were run."""
        return SIMULATED["steps"] - self.before

    @property
    def over(self) -> bool:
        """Return whether nothing more is run."""
        return self.ran >= self.most

    def run(self, rows: list[Row]) -> None:
        """Run explanations at units and fit them again."""
        self._run(rows)
        for name in dict.fromkeys(name for name, _ in rows):
            self.fit(name)

    def screen(self, rows: list[Row]) -> None:
        """Run explanations at units of screening."""
        self._run(rows)
        for name, units in rows:
            if len(units):
                self.trials[name].screened = len(self.trials[name].noise)

    def first(self, name: str, points: int | None = None) -> Row:
        """Return the Row of so many first points of an explanation, all where None, at which it was
        not run.
        """
        tried = self.trials[name].tried if name in self.trials else []
        first = first_points(candidate_named(name))[:points]
        new = [unit for unit in first if not any(np.array_equal(unit, other) for other in tried)]
        return name, np.array(new).reshape(len(new), first.shape[1])

    def _run(self, rows):
        """Run explanations, each point a batch; what cannot be run is kept as failed."""
        seeds = max(1, LANES // len(self.null.records))
        jobs = []
        for name, units in rows:
            candidate = candidate_named(name)
            self.trials.setdefault(name, Trial.empty(candidate, self.null.values))
            if self.over:
                self.ended = self.ended or self.ran
                continue
            for unit in np.atleast_2d(units):
                jobs.append((candidate, unit, self.seed + seeds * len(jobs)))
        self.seed += seeds * len(jobs)
        found = side_by_side(lambda job: self._tried(*job), jobs, self.threads)
        for (candidate, unit, _), changes in zip(jobs, found, strict=True):
            trial = self.trials[candidate.name]
            if isinstance(changes, str):
                trial.failed.append((unit, changes))
            else:
                trial.add(unit, changes)

    def _tried(self, candidate, unit, first_seed):
        """Return changes (seed, value) of one batch of runs, or why there are none."""
        try:
            return self._changes(candidate, unit, first_seed)
        except (IntegrationError, ConfigError) as error:
            return str(error)
        except Exception as error:  # ours: it costs this explanation, not the verdict
            traceback.print_exc()  # to the log
            return f"{IN_PROGRAM}: {type(error).__name__}: {error}"

    def fit(self, name: str) -> None:
        """Fit an explanation again, if it has runs."""
        trial = self.trials[name]
        if not len(trial.noise):
            return
        run_leaves = np.sum((self.null.measured - trial.change) ** 2, axis=1)
        start = trial.unit[np.argmin(run_leaves)]
        found = fit(self.emulator(name), trial.unit.shape[1], self.null, start)
        # of few runs an emulator may smooth away what one of them shows
        self.fits[name] = replace(found, left=min(found.left, float(run_leaves.min())))

    def emulator(self, name: str) -> AnyEmulator:
        """Return the Emulator, or PairEmulator, of an explanation that has runs."""
        trial = self.trials[name]
        if isinstance(trial.candidate, Pair):
            first, second = (
                self.emulator(part.name) for part in (trial.candidate.first, trial.candidate.second)
            )
            return PairEmulator(trial, first, second, self.looked)
        neutral = neutral_unit(trial.candidate, self.scales)
        return Emulator(self._drawn_in(trial), neutral, self.looked, answer=self.null.measured)

    def _drawn_in(self, trial):
        return trial.drawn_in(FARTHEST * float(np.linalg.norm(self.null.measured)))

    def estimate(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return (unit, interval) of the parameters of an explanation: see parameters.estimate."""
        return estimate(self.emulator(name), self.null, self.fits[name])

    def _changes(self, candidate, unit, first_seed):
        bench, records = self.bench, self.null.records
        physical = candidate.physical(unit, self.scales)
        seeds = max(1, LANES // len(records))
        runs = bench.runs(records, seeds, first_seed)
        features = bench.features(
            bench.model(bench.variant(candidate, physical)),
            runs,
            candidate.measuring(physical, bench.signals.names),
        ).reshape(len(records), seeds, -1)
        if np.isnan(features).any():
            raise IntegrationError("a run was thrown off")
        return np.array([self.null.change(features[:, run]) for run in range(seeds)])

    @property
    def effects(self) -> EffectDirections:
        """Return the EffectDirections of all runs of screening."""
        return self._directions({name: trial.screened for name, trial in self.trials.items()})

    def _directions(self, counts):
        """Return the EffectDirections of the first runs of explanations {name: number}, of which
        each counts as much as another, however often it was run.
        """
        trials = [(self.trials[name], count) for name, count in counts.items() if count]
        nothing = np.zeros((0, self.null.values))  # where no explanation could be run
        return EffectDirections.of(
            np.vstack([nothing, *(trial.change[:count] for trial, count in trials)]),
            np.concatenate([[], *(trial.noise[:count] for trial, count in trials)]),
            self.null,
            np.concatenate([[], *(np.full(count, 1.0 / count) for _, count in trials)]),
        )

    def of_families(self) -> dict[str, float]:
        """Return {family: probability}, the most probable first, that what is missing looks like
        what the runs of a family change, whatever its law; each alone, and as probable as another
        before anything was run.
        """
        families: dict[str, list[Trial]] = {}
        for trial in self.trials.values():
            if not isinstance(trial.candidate, Pair) and len(trial.noise):
                families.setdefault(trial.candidate.effect.family, []).append(self._drawn_in(trial))
        found = {
            family: EffectDirections.of(
                np.vstack([trial.change for trial in trials]),
                np.concatenate([trial.noise for trial in trials]),
                self.null,
            )
            for family, trials in families.items()
        }
        nothing = np.zeros(self.null.values)
        evidence = {
            family: float(SomethingElse(along, self.null).log_evidence(nothing))
            for family, along in found.items()
            if len(along.share)
        }
        whole = logsumexp(list(evidence.values())) if evidence else 0.0
        rows = {family: float(np.exp(known - whole)) for family, known in evidence.items()}
        return dict(sorted(rows.items(), key=lambda row: -row[1]))

    def look(self) -> None:
        """Learn, and fit every explanation again."""
        self.learn()
        for name in self.trials:
            self.fit(name)

    def learn(self) -> None:
        """Take what is known of chance along the directions of all runs so far into all that was
        run, and look along them alone.

        The covariance of a few runs is too small along what an effect changes in many values at
        once, and an explanation whose direction it does not know explains chance. Runs are known
        along these directions alone: their scatter is the same in all values, and that of hundreds
        of values would hide what changes in a few directions.
        """
        self._in_units(self.null.out_of_units)
        self.null = self.null.plain
        self.looked = self._directions({name: len(t.noise) for name, t in self.trials.items()})
        self.null = told_of(self.null, self.looked)
        self._in_units(self.null.in_units)

    def _in_units(self, turned):
        """Turn all changes that were run into other units."""
        for trial in self.trials.values():
            trial.change = turned(trial.change)
            trial.deviations = [turned(row) for row in trial.deviations]

    def something_else(self) -> SomethingElse:
        """Return the SomethingElse of all trials."""
        return SomethingElse(self.effects, self.null)

    def explains(self, rest: np.ndarray) -> dict[str, float]:
        """Return {name: chi-square of rest (value,) that the best direction of an explanation's
        runs takes away}, of those screened.
        """
        return {
            name: float(directed(trial, rest).max())
            for name, trial in self.trials.items()
            if trial.screened
        }


LITTLE = 12.0  # chi-square: what takes no more away is not worth a parameter
FARTHEST = 1.2  # times what is measured: larger changes only tell that the answer is not there


def directed(trial: Trial, rest: np.ndarray) -> np.ndarray:
    """Return (run,): the chi-square of rest (value,) that the direction of a run takes away; none
    where its change can not be told from its own scatter.
    """
    scatter = trial.noise * rest.size
    size = np.sum(trial.change**2, axis=1) - scatter
    along = np.maximum(trial.change @ rest, 0.0)
    return np.where(seen(trial.change, trial.noise), along**2 / np.maximum(size, 1.0), 0.0)


def telling(trial: Trial, rest: np.ndarray) -> int:
    """Return the number of the run whose direction takes most of the chi-square of rest (value,)
    away; where none does, of the run that changes most.
    """
    return int(np.lexsort((np.sum(trial.change**2, axis=1), directed(trial, rest)))[-1])


ANYWHERE = 5  # places of an effect that is not there
ANYHOW = [2, 0, 4, 1, 3]  # the order of as many directions
BELOW = -0.2  # of the searched range: where an effect is nothing whose size is searched in its
# logarithm from little to much


def neutral_unit(candidate: Candidate, scales: dict[str, float]) -> np.ndarray | None:
    """Return (point, parameter) normalised where an explanation changes nothing, wherever it sits;
    None where its range holds no such place and does not lead to one.
    """
    unit = candidate.neutral_unit(scales)
    for number, parameter in enumerate(candidate.effect.parameters):
        if parameter.log and parameter.neutral == 0.0:
            unit[number] = BELOW
    rows = np.tile(unit, (ANYWHERE if candidate.along else 1, 1))
    if candidate.along:
        rows[:, -1] = np.linspace(0.0, 1.0, ANYWHERE)
    if candidate.turned:
        rows[:, -2] = np.linspace(0.0, 1.0, 2 * ANYWHERE)[1::2][ANYHOW]
    return rows if np.isfinite(rows).all() else None
