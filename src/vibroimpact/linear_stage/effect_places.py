"""The place along a tube of a linear effect that was found at one of the named points."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy import optimize

from vibroimpact.effects import places

from . import priors
from .candidates import AT_A_POINT, Candidate
from .effect_fit import LinearChanges, LinearResult, fitted
from .effect_readings import LinearTable, table_of
from .workbench import Workbench

NEAR_M = 2.0e-4  # resolution of the search
TURNS = 20
LIKELY = 0.5  # of the best gain, at one end of an interval: others are not searched


def placed(
    bench: Workbench,
    changes: LinearChanges,
    found: Sequence[LinearResult[Candidate]],
    sizes: dict[str, float],
    tables: dict[str, LinearTable],
) -> LinearResult[Candidate] | None:
    """Return the LinearResult of the point effect that explains most, at the place on the tube that
    explains most; None where none explains enough to be adopted, or the place adds less than a
    parameter costs.

    Midpoints between named points are tried first: the best named point is often two spans from the
    place, where the effect changes the modes alike. The model itself is used: the reduced basis
    alone put a mass 1 cm off, which a record with 1 % of noise resolves.

    changes: LinearChanges of a Workbench; found: [LinearResult] at named points; sizes: see
    Candidate.physical; tables are extended.
    """
    rows = [row for row in found if row.candidate.effect_id in AT_A_POINT]
    if not rows:
        return None
    best = max(rows, key=lambda row: row.gain)
    locations = best.candidate.effect.locations(bench.values)
    arcs = places.arc_lengths(bench.values, locations)
    if len(arcs) < 2 or best.gain <= priors.LINEAR_GAIN:
        return None
    gains = {
        arc: row.gain
        for arc, location in zip(arcs, locations, strict=True)
        for row in rows
        if row.candidate == replace(best.candidate, location=location)
    }
    results: dict[float, LinearResult[Candidate] | None] = {}

    def loss(arc):
        candidate = replace(best.candidate, location=places.between(arc))
        results[arc] = fitted(bench, changes, candidate, best.unit, sizes)
        return np.inf if results[arc] is None else -results[arc].gain

    length = places.length_m(bench.values)
    assert length is not None, "only points of a tube have arc lengths"
    ends = (0.0, length)
    for start, end in pairwise(sorted({*ends, *gains})):
        if max(gains.get(start, 0.0), gains.get(end, 0.0)) < LIKELY * best.gain:
            continue
        gains[0.5 * (start + end)] = -loss(0.5 * (start + end))
    own = max(gains, key=lambda arc: gains[arc])
    tried = sorted({*ends, *gains})
    below, above = [arc for arc in tried if arc < own], [arc for arc in tried if arc > own]
    optimize.minimize_scalar(
        loss,
        bounds=(max(below, default=own), min(above, default=own)),
        method="bounded",
        options={"xatol": NEAR_M, "maxiter": TURNS},
    )
    result = max(filter(None, results.values()), key=lambda row: row.gain, default=None)
    if result is None or result.gain <= best.gain + priors.PARAMETER_COST:
        return None
    tables[result.candidate.name] = table_of(bench, result.candidate, sizes, changes)
    return result
