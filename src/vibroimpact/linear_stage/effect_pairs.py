"""Two linear effects at once, fitted to the lowest record: pairs are proposed by adding the changes
of the two effects, and fitted with the model that contains both.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from . import nuisance as linear
from .candidates import Candidate, Pair, candidate_named, unit_grid
from .effect_fit import LinearChanges, LinearResult, fitted
from .effect_readings import LinearTable, reading_under
from .workbench import Workbench

# points along each parameter where a pair is proposed, by the number of parameters
GRID = {1: 13, 2: 6, 3: 4}
KEPT = 40  # second effects that are kept for a first one at a point of its grid
FAR = 10.0  # sigma squared from which on an entry counts by its logarithm
FITTED = 4  # proposals that are fitted with the model itself

Begun = Sequence[tuple[Pair, np.ndarray]]  # pairs to fit, with their normalised parameters


def best_pairs(
    bench: Workbench,
    changes: LinearChanges,
    rows: Sequence[dict[str, Any]],
    scales: dict[str, float],
    tables: Mapping[str, LinearTable],
    begun: Begun = (),
) -> list[LinearResult[Pair]]:
    """Return [LinearResult], best first, of two effects at once that explain the lowest record of a
    Workbench.

    changes: LinearChanges of it; begun: pairs to be fitted in addition to those proposed here;
    rows: [{name, unit, gain, ...}] of single effects, best first; tables {name: LinearTable} of
    those that change the model.
    """
    found = [
        fitted(bench, changes, pair, unit, scales)
        for pair, unit in [*begun, *proposed(bench, rows, scales, tables)[:FITTED]]
    ]
    best: dict[frozenset, LinearResult[Pair]] = {}
    for row in filter(None, found):
        key = frozenset((row.candidate.first, row.candidate.second))
        best[key] = max(row, best.get(key, row), key=lambda one: one.gain)
    return sorted(best.values(), key=lambda row: -row.gain)


def proposed(
    bench: Workbench,
    rows: Sequence[dict[str, Any]],
    scales: dict[str, float],
    tables: Mapping[str, LinearTable],
) -> list[tuple[Pair, np.ndarray]]:
    """Return [(Pair, unit (parameter,))], best first, of every two effects, each at the points of a
    grid: their changes are added.

    Far from the measurement the worst entry dominates a Gaussian likelihood. Here an entry counts
    by the logarithm of its distance where that is large.
    """
    measured = bench.measured_reading
    bare = linear.reading_of_model(bench.bare, bench.measured_fit.modes)
    seen = linear.seen_by(measured, measured)
    target, covariance, sensitivity = linear.difference(measured, bare, seen)
    sd = np.sqrt(np.diag(covariance) + np.sum(sensitivity**2, axis=1))
    candidates: list[Candidate] = []
    units: list[np.ndarray] = []
    whitened: list[np.ndarray] = []
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
            whitened.append((target - there) / sd)
    changes = np.array(whitened)
    best: dict[frozenset, tuple[float, Pair, np.ndarray]] = {}
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
