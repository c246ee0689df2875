"""The strength that amounts of the effects have: excess over floor on the hold-out record, for choosing the ranges of amounts.py.

All amounts share one force and one bare rig, and the floor is the bare rig's: a quick look. The truth of a drawn campaign states its own.
"""

from functools import lru_cache

import numpy as np

from vibroimpact_truth.amounts import AMOUNTS
from vibroimpact_truth.campaign import SAMPLING, Plan, forces, measured, noise_of, records_of
from vibroimpact_truth.strength import distance, excess


@lru_cache(maxsize=2)
def bare(seed, duration, tube):
    """(plan, force, noise, two bare hold-out responses) that all amounts are held against."""
    plan = Plan((seed,), tube=tube, duration=duration, levels=((0.5, 1.3, "fit"), (10.0, 0.9, "holdout")))
    force = forces(plan)
    both = records_of(plan, force)[0]
    again = records_of(plan, force, start_stream=1, only="holdout")[0]
    return plan, force, noise_of(plan, both), both[1:], again


def measure(effect, amount, seed, duration=20.0, tube="stand_in"):
    """(parameters, {floor_dB, excess, either}) of an amount of an effect: its excess in floors, also counting silenced bands."""
    plan, force, noise, *twins = bare(seed, duration, tube)
    parameters = AMOUNTS[effect].parameters(amount, np.random.default_rng([seed, 99]))
    hiding = Plan(plan.seed, ((effect, parameters),), tube=tube, duration=duration, levels=plan.levels)
    response = records_of(hiding, force, start_stream=2, only="holdout")[0]
    one, other = (measured(plan, force[1:], twin, noise, stream)[1] for stream, twin in enumerate(twins, 1))
    seen = measured(hiding, force[1:], response, noise)[1]
    floor = excess(one, other, other, noise, SAMPLING)["lsd_dB"]
    found = {}
    for either in (False, True):
        lsd = distance(seen[0], one[0], noise, SAMPLING, either)
        found["either" if either else "excess"] = round(float(np.sqrt(max(0.0, lsd**2 - floor**2)) / floor), 2)
    return parameters, {"floor_dB": floor, **found}


def table(effects, seed, duration=20.0, tube="stand_in"):
    """Print a line per amount of every effect: the ends of its medium and strong ranges."""
    for effect in effects:
        row = AMOUNTS[effect]
        for amount in (*row.medium, *(row.strong or ())):
            try:
                parameters, found = measure(effect, amount, seed, duration, tube)
            except FloatingPointError as problem:
                print(f"{effect} {amount:g} {problem}", flush=True)
            else:
                print(f"{effect:26s} {amount:10.4g} {found['excess']:6.2f} {found['either']:6.2f} {parameters}", flush=True)
