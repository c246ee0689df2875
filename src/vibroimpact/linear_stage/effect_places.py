"""Where along a tube a linear effect sits that was found at one of its named points."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy import optimize

from vibroimpact.discrepancy import priors
from vibroimpact.effects import places

from .candidates import AT_A_POINT
from .effect_fit import fitted
from .effect_readings import table_of

NEAR_M = 2.0e-4  # closer is not looked
TURNS = 20
LIKELY = 0.5  # of the best gain, at one end of a stretch: others are not looked at


def placed(bench, changes, found, sizes, tables):
    """Return the LinearResult of the effect at a point that explains most, at the place on the tube
    that explains most; None where none explains enough to be adopted, or the place adds less than
    a parameter costs. Halfway between named points first: the best of these is often two spans
    from the place, where the modes that it moves are alike.

    With the model itself: the reduced basis alone put a mass 1 cm off, which a record with 1 % of
    noise told from where it was.

    changes: LinearChanges of a Workbench; found: [LinearResult] at named points; tables are
    extended.
    """
    rows = [row for row in found if row.candidate.effect_id in AT_A_POINT]
    if not rows:
        return None
    best = max(rows, key=lambda row: row.gain)
    locations = best.candidate.effect.locations(bench.values)
    arcs = places.arc_lengths(bench.values, locations)
    if len(arcs) < 2 or best.gain <= priors.LINEAR_GAIN:
        return None
    looked = {
        arc: row.gain
        for arc, location in zip(arcs, locations, strict=True)
        for row in rows
        if row.candidate == replace(best.candidate, location=location)
    }
    results = {}

    def loss(arc):
        candidate = replace(best.candidate, location=places.between(arc))
        results[arc] = fitted(bench, changes, candidate, best.unit, sizes)
        return np.inf if results[arc] is None else -results[arc].gain

    ends = (0.0, places.length_m(bench.values))
    for below, above in pairwise(sorted({*ends, *looked})):
        if max(looked.get(below, 0.0), looked.get(above, 0.0)) < LIKELY * best.gain:
            continue
        looked[0.5 * (below + above)] = -loss(0.5 * (below + above))
    own = max(looked, key=looked.get)
    near = sorted({*ends, *looked})
    below, above = [arc for arc in near if arc < own], [arc for arc in near if arc > own]
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
