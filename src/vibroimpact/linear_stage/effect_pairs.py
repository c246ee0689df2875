"""Two linear effects at once against the lowest record: proposed by adding what each of them
changes, fitted with the model that holds both.
"""

import numpy as np

from . import nuisance as linear
from .candidates import Pair, candidate_named, unit_grid
from .effect_fit import fitted
from .effect_readings import reading_under

GRID = {
    1: 13,
    2: 6,
    3: 4,
}  # points along each parameter where a pair is proposed, by the number of parameters
KEPT = 40  # of the second effects to a first one at a point of its grid
FAR = 10.0  # sigma squared from which on an entry counts by its logarithm
FITTED = 4  # proposals that are fitted with the model itself


def best_pairs(bench, changes, rows, scales, tables, begun=()):
    """Return [LinearResult], best first, of two effects at once that explain the lowest record of a
    Workbench.

    changes: LinearChanges of it; begun: [(Pair, unit)] to be fitted beside those that are proposed
    here; rows: [{name, unit, gain, ...}] of single effects, best first; tables {name: LinearTable}
    of those that change the model.
    """
    found = [
        fitted(bench, changes, pair, unit, scales)
        for pair, unit in [*begun, *proposed(bench, rows, scales, tables)[:FITTED]]
    ]
    best = {}
    for row in filter(None, found):
        key = frozenset((row.candidate.first, row.candidate.second))
        best[key] = max(row, best.get(key, row), key=lambda one: one.gain)
    return sorted(best.values(), key=lambda row: -row.gain)


def proposed(bench, rows, scales, tables):
    """Return [(Pair, unit (parameter,))], best first: every two effects at the points of a grid
    each, what they change added.

    Far from the measurement the likelihood knows but its worst entry: here an entry that is far off
    counts by the logarithm of how far.
    """
    measured = bench.measured_reading
    bare = linear.reading_of_model(bench.bare, bench.measured_fit.modes)
    seen = linear.seen_by(measured, measured)
    target, covariance, sensitivity = linear.difference(measured, bare, seen)
    sd = np.sqrt(np.diag(covariance) + np.sum(sensitivity**2, axis=1))
    candidates, units, changes = [], [], []
    for row in rows:
        candidate = candidate_named(row["name"])
        count = len(candidate.effect.parameters)
        for unit in [np.array(row["unit"]), *unit_grid(count, GRID[count])]:
            there = linear.difference(
                measured,
                reading_under(bench, candidate, unit, scales, tables.get(candidate.name)),
                seen,
            )[0]
            candidates.append(candidate)
            units.append(unit)
            changes.append((target - there) / sd)
    changes, best = np.array(changes), {}
    for first, change in enumerate(changes):
        scores = -np.sum(np.log1p((target / sd - change - changes[first + 1 :]) ** 2 / FAR), axis=1)
        for other in np.argsort(scores)[::-1][:KEPT]:
            second = first + 1 + other
            key = frozenset((candidates[first], candidates[second]))
            if candidates[first].effect_id != candidates[second].effect_id and (
                key not in best or scores[other] > best[key][0]
            ):
                best[key] = (
                    scores[other],
                    Pair(candidates[first], candidates[second]),
                    np.concatenate([units[first], units[second]]),
                )
    return [(pair, unit) for _, pair, unit in sorted(best.values(), key=lambda row: -row[0])]
