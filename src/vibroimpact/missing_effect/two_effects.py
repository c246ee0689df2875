"""Two effects at once, where one leaves room for a second."""

from collections.abc import Callable

import numpy as np

from vibroimpact.linear_stage.candidates import Candidate, Pair, candidate_named

from .alike import is_like
from .first_points import first_points
from .race import leaders
from .search import Search

Room = Callable[[Pair], bool]  # whether two effects may be looked for together


def parts_alone(search: Search, pair: str) -> None:
    """Run each of two effects alone where both are thought to be: one may do without the other."""
    trial, found = search.trials[pair], search.fits[pair]
    search.run([(part.name, unit) for part, unit in trial.candidate.parts(found.unit)])


def seek_pairs(search: Search, room: Room, firsts: int = 2, seconds: int = 6) -> list[str]:
    """Run the leading explanations with a second effect each, of those that may explain what the
    first leaves and for which there is room; return the pairs' names.
    """
    rows: dict[str, np.ndarray] = {}
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
            if {pair, reverse} & {*search.trials, *rows}:
                continue
            rest = search.null.measured - found.mean
            trial = search.trials[second]
            near = trial.unit[np.argsort(np.sum((rest - trial.change) ** 2, axis=1))[:2]]
            rows[pair] = np.hstack([np.tile(found.unit, (len(near), 1)), near])
    search.run(list(rows.items()))
    return list(rows)


def exchanged_too(search: Search, pair: str, room: Room) -> bool:
    """Run a leading pair with each of its effects in turn exchanged for what is like it, return
    whether there is any.

    The first of two was chosen as if it were alone: where it is of another law than the one that is
    missing, no second makes up for it, and with a second the right law may explain what neither
    does by itself.
    """
    parts = search.trials[pair].candidate.parts(search.fits[pair].unit)
    rows: dict[str, np.ndarray] = {}
    for (kept, at), (leading, unit) in (parts, parts[::-1]):
        for name in list(search.trials):
            other = search.trials[name].candidate
            if not is_like(search, name, leading) or {*other.ids} & {*kept.ids}:
                continue
            both, reverse = Pair(kept, other), Pair(other, kept).name
            if {both.name, reverse} & {*search.trials, *rows} or not room(both):
                continue
            there = _points(other, leading, unit)
            rows[both.name] = np.hstack([np.tile(at, (len(there), 1)), there])
    search.run(list(rows.items()))
    return bool(rows)


def _points(other: Candidate, leading: Candidate, unit: np.ndarray) -> np.ndarray:
    """Return (point, parameter): first points of another law, where a leading one is found."""
    count = len(other.effect.parameters)
    points = first_points(other)[: 2 * count]
    if other.along and leading.along:
        points[:, -1] = unit[-1]
    return points
