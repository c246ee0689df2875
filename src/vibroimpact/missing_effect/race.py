"""The race: what may be the answer is run until one is sure or nothing more is to be learned."""

from collections.abc import Sequence

import numpy as np

from vibroimpact.linear_stage.candidates import Pair

from .effect_directions import seen
from .effort import Effort
from .search import LITTLE, Search
from .trials import Trial

WIDER = 4  # points for each parameter


def look_wider(search: Search, count: int) -> None:
    """Run what did nothing so far, and the `count` explanations that may explain most, more than
    all that was run, at more points: what resonates, as a support plate, is seen near its answer
    alone.
    """
    best = max((found.takes for found in search.fits.values()), default=0.0)
    alone = {
        name: found.may_take
        for name, found in search.fits.items()
        if not isinstance(search.trials[name].candidate, Pair)
    }
    idle = [name for name in alone if not seen_at_all(search.trials[name])]
    search.screen([search.first(name) for name in idle])
    for name in idle:
        search.fit(name)
    may = [
        name
        for name in sorted(alone, key=lambda name: -alone[name])
        if name not in idle and alone[name] > best and search.trials[name].screened > 1
    ]
    for name in may[:count]:
        trial = search.trials[name]
        before = len(trial.noise)
        for _ in trial.candidate.effect.parameters:
            refine(search, [name], WIDER)
        trial.strewn += len(trial.noise) - before


def seen_at_all(trial: Trial) -> bool:
    """Return whether any run of a Trial changed what is told from its scatter."""
    return bool(seen(trial.change, trial.noise).any())


NEW = 0.02  # of the searched range: a point that is nearer to one that was run tells little


def refine(search: Search, names: list[str], points: int) -> None:
    """Run explanations at `points` points each, by turns where least is expected to be left and
    where least may be left.

    The first of them, unless it was run there; others near the likely ones.
    """
    random, rows = np.random.default_rng(search.seed), []
    for name in names:
        found, trial = search.fits[name], search.trials[name]
        chosen = [
            random.choice(len(found.samples), p=(found.weight, found.open_weight)[number % 2])
            for number in range(points)
        ]
        near = 0.04 * random.standard_normal((points, found.samples.shape[1]))
        units = np.clip(found.samples[chosen] + near, 0.0, 1.0)
        if np.abs(trial.unit - found.unit).max(axis=1).min() > NEW:
            units[0] = found.unit
        rows.append((name, units))
    search.run(rows)


DECIDED = 7.0  # of log probability: what is so much less probable is out of the race
RUNS = 16  # of an explanation at most, beside those screened; twice as many of the leading one
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
        if max(explains.get(name, np.inf), fits[name].takes) > LITTLE
        and (laws or upper[name] > best - DECIDED)
        and search.trials[name].refined < RUNS * (1 + (known[name] == best))
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
