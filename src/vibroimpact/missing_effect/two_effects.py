"""Two effects at once, where one leaves room for a second."""

from collections.abc import Callable

import numpy as np

from vibroimpact.linear_stage.candidates import Pair, candidate_named

from .race import leaders
from .search import Search


def parts_alone(search: Search, pair: str) -> None:
    """Run each of two effects alone where both are thought to be: one may do without the other."""
    trial, found = search.trials[pair], search.fits[pair]
    search.run([(part.name, unit) for part, unit in trial.candidate.parts(found.unit)])


def seek_pairs(
    search: Search, room: Callable[[Pair], bool], firsts: int = 2, seconds: int = 6
) -> list[str]:
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
