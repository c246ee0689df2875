"""Two linear effects at once against the lowest record: proposed by adding what each of them changes, fitted with the model that holds both."""

import numpy as np

from vibroimpact.discrepancy import nuisance as linear
from vibroimpact.discrepancy.candidates import Pair, candidate_named
from vibroimpact.discrepancy.linear_fit import fitted, moved
from vibroimpact.discrepancy.linear_naming import reading_under

FIRSTS = 6  # best single effects that are tried with every other one
GRID = {1: 13, 2: 6, 3: 4}  # points along each parameter where a pair is proposed, by the number of parameters
FITTED = 3  # proposals that are fitted with the model itself


def best_pairs(bench, changes, rows, scales, tables):
    """Return [LinearResult], best first, of two effects at once that explain the lowest record of a Workbench.

    changes: LinearChanges of it; rows: [{name, unit, gain, ...}] of single effects, best first; tables {name: LinearTable} of those that change the model.
    """
    found = [fitted(bench, changes, pair, unit, scales) for pair, unit in proposed(bench, rows, scales, tables)[:FITTED]]
    return sorted((row for row in found if row is not None), key=lambda row: -row.gain)


def proposed(bench, rows, scales, tables):
    """Return [(Pair, unit (parameter,))], best first: the best single effects as they were read alone, each with every other one where that adds most."""
    bare, measured, error = linear.reading_of_model(bench.bare, bench.measured_fit.modes), bench.measured_reading, bench.measured_fit.covariance
    grids = {}
    for row in rows:
        candidate = candidate_named(row["name"])
        axis = np.linspace(0.0, 1.0, GRID[len(candidate.effect.parameters)])
        units = np.stack([axes.ravel() for axes in np.meshgrid(*[axis] * len(candidate.effect.parameters), indexing="ij")], axis=-1)
        units = np.vstack([row["unit"], units])
        grids[candidate] = units, [reading_under(bench, candidate, unit, scales, tables.get(candidate.name)) for unit in units]
    best = {}
    for first in list(grids)[:FIRSTS]:
        own, alone = grids[first][0][0], grids[first][1][0]
        for second, (units, readings) in grids.items():
            if second.effect_id == first.effect_id:
                continue
            scores = [linear.likelihood(measured, moved(alone, reading, bare), error)[0] for reading in readings]
            top, key = int(np.argmax(scores)), frozenset((first, second))
            if key not in best or scores[top] > best[key][0]:
                best[key] = scores[top], Pair(first, second), np.concatenate([own, units[top]])
    return [(pair, unit) for _, pair, unit in sorted(best.values(), key=lambda row: -row[0])]
