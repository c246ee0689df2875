"""Where along a tube a linear effect sits that was found at one of its named points."""

from dataclasses import replace

from scipy import optimize

from vibroimpact.effects import places

from .candidates import AT_A_POINT
from .linear_naming import calibrate, table_of

NEAR_M = 1.0e-4  # closer is not looked
TURNS = 20


def placed(bench, changes, found, sizes, tables):
    """Return the LinearResult of the effect at a point that explains most, at the place between its
    neighbours on the tube that explains most; None where there is none.

    changes: LinearChanges of a Workbench; found: [LinearResult] at named points; tables are
    extended.
    """
    rows = [row for row in found if row.candidate.effect_id in AT_A_POINT]
    if not rows:
        return None
    best = max(rows, key=lambda row: row.gain)
    locations = best.candidate.effect.locations(bench.values)
    arcs = places.arc_lengths(bench.values, locations)
    if len(arcs) < 2:
        return None
    own = dict(zip(locations, arcs, strict=True))[best.candidate.location]
    below, above = [arc for arc in arcs if arc < own], [arc for arc in arcs if arc > own]
    results = {}

    def loss(arc):
        candidate = replace(best.candidate, location=places.between(arc))
        table = table_of(bench, candidate, sizes, changes)
        results[arc] = calibrate(bench, candidate, sizes, table), table
        return -results[arc][0].gain

    at = optimize.minimize_scalar(
        loss,
        bounds=(max(below, default=own), min(above, default=own)),
        method="bounded",
        options={"xatol": NEAR_M, "maxiter": TURNS},
    ).x
    result, table = results[at]
    tables[result.candidate.name] = table
    return result if result.gain > best.gain else None
