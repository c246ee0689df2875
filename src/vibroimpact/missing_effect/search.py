"""The search: every explanation is run at a few points, the likely ones at more, until one is sure
or nothing more is to be learned.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from vibroimpact.config.reading import ConfigError
from vibroimpact.discrepancy.candidates import (
    Candidate,
    Pair,
    candidate_named,
    elsewhere,
    other_places,
)
from vibroimpact.discrepancy.workbench import Workbench
from vibroimpact.effects.effect import Values
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.lanes import LANES

from .effect_directions import EffectDirections, seen, told_of
from .effort import Effort
from .evidence import SomethingElse, fit
from .null import Null
from .trials import AnyEmulator, Emulator, PairEmulator, Trial


@dataclass
class Search:
    """A Workbench of what is compared, its Null, and all Trials so far {name: Trial} with their
    Fits {name: Fit}. looked: see look; None: all that runs change is known.
    """

    bench: Workbench
    null: Null
    scales: dict
    trials: dict = field(default_factory=dict)
    fits: dict = field(default_factory=dict)
    seed: int = 1000
    looked: EffectDirections | None = None

    def run(self, name: str, units: np.ndarray) -> None:
        """Run an explanation at units (point, parameter) and fit it again."""
        self._run(name, units)
        self.fit(name)

    def run_first(self, name: str, points: int) -> None:
        """Run an explanation at those of so many of its first points where it was not run."""
        tried = self.trials[name].tried if name in self.trials else []
        first = first_points(candidate_named(name))[:points]
        new = [unit for unit in first if not any(np.array_equal(unit, other) for other in tried)]
        if new:
            self.run_screened(name, np.array(new))

    def run_screened(self, name: str, units: np.ndarray) -> None:
        """Run an explanation at units (point, parameter) of screening."""
        self._run(name, units)
        self.trials[name].screened = len(self.trials[name].noise)

    def _run(self, name, units):
        """Run an explanation at units (point, parameter); what cannot be run is kept as failed."""
        candidate = candidate_named(name)
        trial = self.trials.setdefault(name, Trial.empty(candidate, self.null.values))
        for unit in np.atleast_2d(units):
            try:
                trial.add(unit, *self._change(candidate, unit))
            except (IntegrationError, ConfigError) as error:
                trial.failed.append((unit, str(error)))

    def fit(self, name: str) -> None:
        """Fit an explanation again, if it has runs."""
        trial = self.trials[name]
        if not len(trial.noise):
            return
        start = trial.unit[np.argmin(np.sum((self.null.measured - trial.change) ** 2, axis=1))]
        self.fits[name] = fit(self.emulator(name), trial.unit.shape[1], self.null, start)

    def emulator(self, name: str) -> AnyEmulator:
        """Return the Emulator, or PairEmulator, of an explanation that has runs."""
        trial = self.trials[name]
        if isinstance(trial.candidate, Pair):
            first, second = (
                self.emulator(part.name) for part in (trial.candidate.first, trial.candidate.second)
            )
            return PairEmulator(trial, first, second, self.looked)
        near = trial.drawn_in(FARTHEST * np.linalg.norm(self.null.measured))
        return Emulator(near, neutral_unit(trial.candidate, self.scales), self.looked)

    def _change(self, candidate, unit):
        """Return (change (value,), variance of a value) of one batch of runs."""
        bench, records = self.bench, self.null.records
        physical = candidate.physical(unit, self.scales)
        seeds = max(1, LANES // len(records))
        runs = bench.runs(records, seeds, self.seed)
        self.seed += seeds
        features = bench.features(
            bench.model(bench.variant(candidate, physical)),
            runs,
            candidate.measuring(physical, bench.signals.names),
        ).reshape(len(records), seeds, -1)
        if np.isnan(features).any():
            raise IntegrationError("a run was thrown off")
        each = np.array([self.null.change(features[:, run]) for run in range(seeds)])
        noise = each.var(axis=0, ddof=1).mean() if seeds > 1 else 1.0
        return self.null.change(features.mean(axis=1)), noise / seeds

    @property
    def effects(self) -> EffectDirections:
        """Return the EffectDirections of all runs of screening."""
        return self._directions({name: trial.screened for name, trial in self.trials.items()})

    def _directions(self, counts):
        """Return the EffectDirections of the first runs of explanations {name: number}."""
        trials = [(self.trials[name], count) for name, count in counts.items()]
        nothing = np.zeros((0, self.null.values))  # where no explanation could be run
        return EffectDirections.of(
            np.vstack([nothing, *(trial.change[:count] for trial, count in trials)]),
            np.concatenate([[], *(trial.noise[:count] for trial, count in trials)]),
            self.null,
        )

    def look(self) -> None:
        """Look along the directions of all runs so far, and fit every explanation again.

        Runs are known along them alone: their scatter is the same in all values, and that of
        hundreds of values would hide what changes in a few directions.
        """
        runs = {name: len(trial.noise) for name, trial in self.trials.items()}
        self.looked = self._directions(runs)
        for name in self.trials:
            self.fit(name)

    def something_else(self) -> SomethingElse:
        """Return the SomethingElse of all trials."""
        return SomethingElse(self.effects, self.null)

    def learn(self) -> None:
        """Take what is known of chance along the directions of effects into all that was run."""
        self.null = told_of(self.null, self.effects)
        for trial in self.trials.values():
            trial.change = self.null.in_units(trial.change)

    def explains(self, rest: np.ndarray) -> dict[str, float]:
        """Return {name: chi-square of rest (value,) that the best direction of an explanation's
        runs takes away}, of those screened.
        """
        return {
            name: float(directed(trial, rest).max())
            for name, trial in self.trials.items()
            if trial.screened
        }


FARTHEST = 3.0  # times what is measured: larger changes only tell that the answer is not there


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


BELOW = -0.2  # of the searched range: where an effect is nothing whose size is searched in its
# logarithm from little to much


def neutral_unit(candidate: Candidate, scales: dict[str, float]) -> np.ndarray | None:
    """Return (parameter,) normalised where an explanation changes nothing, None where its range
    holds no such place and does not lead to one.
    """
    unit = candidate.neutral_unit(scales)
    for number, parameter in enumerate(candidate.effect.parameters):
        if parameter.log and parameter.neutral == 0.0:
            unit[number] = BELOW
    return unit if np.isfinite(unit).all() else None


# Points at which an explanation is run first, by the number of its parameters.
FIRST = {
    1: ((0.75,), (0.3,), (0.1,), (0.55,)),
    2: ((0.8, 0.5), (0.3, 0.3), (0.5, 0.8), (0.7, 0.2)),
    3: ((0.7, 0.7, 0.7), (0.3, 0.3, 0.3), (0.3, 0.7, 0.5), (0.7, 0.3, 0.5)),
}
# Of a vector: first as large as may be seen in both directions, then smaller.
VECTOR = ((0.75, 0.75), (0.6, 0.4), (0.3, 0.7), (0.5, 0.35))


def first_points(candidate: Candidate) -> np.ndarray:
    """Return (point, parameter): where an explanation is run first."""
    count = len(candidate.effect.parameters)
    vector = count == 2 and len(candidate.signed) == 2
    return np.array(VECTOR if vector else FIRST[count])


def first_explanations(screened: list[str], places: int = 2) -> list[str]:
    """Return the names to begin with: of every effect `places` places at most."""
    by_effect: dict[str, list[str]] = {}
    for name in screened:
        by_effect.setdefault(candidate_named(name).effect_id, []).append(name)
    return [name for names in by_effect.values() for name in names[:places]]


WIDER = 4  # points for each parameter


def look_wider(search: Search) -> None:
    """Run what may explain more than all that was run, and what did nothing so far, at more points:
    what resonates, as a support plate, is seen near its answer alone.
    """
    best = max((found.takes for found in search.fits.values()), default=0.0)
    for name, found in list(search.fits.items()):
        trial = search.trials[name]
        if isinstance(trial.candidate, Pair):
            continue
        before = len(trial.noise)
        if not seen(trial.change, trial.noise).any():
            search.run_first(name, 4)
            search.fit(name)
        elif trial.screened > 1 and found.may_take > best:
            for _ in trial.candidate.effect.parameters:
                refine(search, [name], WIDER)
            trial.strewn += len(trial.noise) - before


LITTLE = 12.0  # chi-square: what takes no more away is not worth a parameter
MAY = 0.25  # of the chi-square that the best direction takes away
LEAST = 6


def screen(search: Search, names: list[str], values: Values) -> None:
    """Run every explanation at two points for each parameter, at single supports where it explains
    most at all of them, and those that may explain the measurement at more.
    """
    for name in names:
        search.run_first(name, 2 * len(candidate_named(name).effect.parameters))
        at_all = search.trials[name]
        for other in elsewhere(candidate_named(name), values):
            if len(at_all.noise):
                search.run_screened(other.name, at_all.unit[telling(at_all, search.null.measured)])
    search.learn()
    for name in may_explain(search):
        search.run_first(name, 4)
    search.look()


def may_explain(search: Search) -> list[str]:
    """Return the names of explanations whose best direction takes much of the chi-square away, the
    most first; none where little is to be taken away.
    """
    explains = search.explains(search.null.measured)
    order = sorted(explains, key=lambda name: -explains[name])
    return [
        name
        for name in order
        if explains[name] > LITTLE
        and (explains[name] > MAY * explains[order[0]] or name in order[:LEAST])
    ]


NEW = 0.02  # of the searched range: a point that is nearer to one that was run tells little


def refine(search: Search, names: list[str], points: int) -> None:
    """Run explanations at `points` points each: where least is expected to be left, unless it was
    run there, and others drawn from what is known of their parameters.
    """
    random = np.random.default_rng(search.seed)
    for name in names:
        found, trial = search.fits[name], search.trials[name]
        drawn = found.samples[random.choice(len(found.samples), points, p=found.open_weight)]
        units = np.clip(drawn + 0.04 * random.standard_normal(drawn.shape), 0.0, 1.0)
        if np.abs(trial.unit - found.unit).max(axis=1).min() > NEW:
            units[0] = found.unit
        search.run(name, units)


DECIDED = 7.0  # of log probability: what is so much less probable is out of the race
RUNS = 16  # of an explanation at most, beside those screened
LEAST_RUNS = 3
KNOWN = 2.0  # of log probability: what may be hidden of one that is known well enough
OF_REST = (
    0.05  # of what the best leaves beyond chance: where nothing explains, less is known enough
)


def contenders(search: Search, pairs: bool = False, laws: Sequence[str] = ()) -> list[str]:
    """Return the names of explanations that may yet explain as much as the best and are not known
    well enough: by turns those that explain most, and those that may explain more than is known.

    laws: of these alone, however much less they explain so far.
    """
    fits = {
        name: found
        for name, found in search.fits.items()
        if ("+" in name) == pairs and (name in laws or not laws)
    }
    # by chi-square: far from the measurement, a likelihood is that of what laws may differ by
    known = {name: 0.5 * found.takes for name, found in fits.items()}
    upper = {name: 0.5 * found.may_take for name, found in fits.items()}
    best = max(known.values(), default=0.0)
    rest = min((found.left for found in fits.values()), default=0.0) - search.null.values
    enough = max(KNOWN, OF_REST * 0.5 * rest)
    explains = search.explains(search.null.measured)  # of those screened
    left = [
        name
        for name in upper
        if explains.get(name, np.inf) > LITTLE
        and (laws or upper[name] > best - DECIDED)
        and search.trials[name].refined < RUNS
        and (
            max(upper[name] - known[name], search.fits[name].not_shown) > enough
            or search.trials[name].refined < LEAST_RUNS
        )
    ]
    rows = [sorted(left, key=lambda name: -of[name]) for of in (known, upper)]
    return list(dict.fromkeys(name for pair in zip(*rows, strict=True) for name in pair))


def race(
    search: Search, spent: Effort, pairs: bool = False, laws: Sequence[str] = (), points: int = 2
) -> None:
    """Run contenders, as many at a time as an Effort spends, until none is left or its rounds are
    over; laws: see contenders.
    """
    for _ in range(spent.rounds):
        names = contenders(search, pairs, laws)[: spent.width]
        if not names:
            return
        refine(search, names, points)


def leaders(search: Search, count: int, pairs: bool = False) -> list[str]:
    """Return the `count` explanations of which a run leaves least, of those that bring the model
    nearer to the measurement.
    """
    nothing = float(search.null.measured @ search.null.measured)
    left = {
        name: found.left
        for name, found in search.fits.items()
        if ("+" in name) == pairs and found.left < nothing
    }
    return sorted(left, key=lambda name: left[name])[:count]


def _similar(effect, leading):
    """Return whether an Effect may look like a leading one."""
    return effect.family == leading.family or effect.id in leading.aliases


def laws_of(search: Search, name: str) -> list[str]:
    """Return the names of what was run of a leading explanation's family, at its place or at that
    of the first runs.
    """
    leading = candidate_named(name)
    return [
        other
        for other, trial in search.trials.items()
        if "+" not in other
        and other in search.fits
        and trial.candidate.effect.family == leading.effect.family
        and (trial.screened > 1 or trial.candidate.location == leading.location)
    ]


def similar_too(search: Search, name: str) -> None:
    """Run what has a signature like a leading explanation's at as many first points as may be: at
    two, a law may be as good as rigid, or do nothing.
    """
    leading = candidate_named(name)
    if isinstance(leading, Pair):
        return
    for other, trial in search.trials.items():
        if (
            "+" not in other
            and not trial.refined
            and _similar(trial.candidate.effect, leading.effect)
            and (trial.screened > 1 or trial.candidate.location == leading.location)
        ):
            search.run_first(other, 4)
            search.fit(other)


def elsewhere_too(search: Search, values: Values, name: str) -> None:
    """Run a leading explanation at other places: of an effect at a point at the other points, of
    one at all supports at each of them alone.
    """
    candidate, unit = candidate_named(name), search.fits[name].unit
    for other in [*other_places(candidate, values), *elsewhere(candidate, values)]:
        if other.name not in search.trials:
            search.run(other.name, unit)


def parts_alone(search: Search, pair: str) -> None:
    """Run each of two effects alone where both are thought to be: one may do without the other."""
    trial, found = search.trials[pair], search.fits[pair]
    for part, unit in trial.candidate.parts(found.unit):
        search.run(part.name, unit)


def seek_pairs(
    search: Search, room: Callable[[Pair], bool], firsts: int = 2, seconds: int = 6
) -> list[str]:
    """Run the leading explanations with a second effect each, of those that may explain what the
    first leaves and for which there is room; return the pairs' names.
    """
    out = []
    for first in leaders(search, firsts):
        found = search.fits[first]
        explains = search.explains(search.null.measured - found.mean)
        own = candidate_named(first)
        order = [
            name
            for name in sorted(explains, key=lambda name: -explains[name])
            if not set(candidate_named(name).ids) & set(own.ids) and "+" not in name
        ]
        order = [name for name in order if room(Pair(own, candidate_named(name)))]
        for second in order[:seconds]:
            pair = Pair(own, candidate_named(second)).name
            reverse = Pair(candidate_named(second), own).name
            if pair in search.trials or reverse in search.trials:
                continue
            rest = search.null.measured - found.mean
            trial = search.trials[second]
            near = trial.unit[np.argsort(np.sum((rest - trial.change) ** 2, axis=1))[:2]]
            search.run(pair, np.hstack([np.tile(found.unit, (len(near), 1)), near]))
            out.append(pair)
    return out
