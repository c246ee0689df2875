"""The strength that amounts of the effects have: excess over floor on the hold-out record, for choosing the ranges of amounts.py.

All amounts share one force and one bare rig, and the floor is the bare rig's: a quick look. The truth of a drawn campaign states its own.
"""

from functools import lru_cache

import numpy as np

from vibroimpact_truth.amounts import AMOUNTS
from vibroimpact_truth.campaign import CHANNELS, SAMPLING, Plan, forces, measured, noise_of, records_of
from vibroimpact_truth.strength import excess


@lru_cache(maxsize=2)
def bare(seed, duration, tube):
    """(plan, force, noise, two bare hold-out responses) that all amounts are held against."""
    plan = Plan((seed,), tube=tube, duration=duration, levels=((0.5, 1.3, "fit"), (10.0, 0.9, "holdout")))
    force = forces(plan)
    both = records_of(plan, force)[0]
    again = records_of(plan, force, start_stream=1, only="holdout")[0]
    return plan, force, noise_of(plan, both), both[1:], again


def measure(effect, amount, seed, duration=20.0, tube="stand_in"):
    """(parameters, {lsd_dB, floor_dB, excess_dB, excess_over_floor}) of an amount of an effect."""
    plan, force, noise, *twins = bare(seed, duration, tube)
    parameters = AMOUNTS[effect].parameters(amount, np.random.default_rng([seed, 99]))
    hiding = Plan(plan.seed, ((effect, parameters),), tube=tube, duration=duration, levels=plan.levels)
    response = records_of(hiding, force, start_stream=2, only="holdout")[0]
    one, other = (measured(plan, force[1:], twin, noise, stream)[1] for stream, twin in enumerate(twins, 1))
    seen = measured(hiding, force[1:], response, noise)[1]
    floor = excess(one, other, other, noise, SAMPLING, ["holdout"], len(CHANNELS))["holdout"]["lsd_dB"]
    lsd = excess(seen, one, other, noise, SAMPLING, ["holdout"], len(CHANNELS))["holdout"]["lsd_dB"]
    value = np.sqrt(max(0.0, lsd**2 - floor**2))
    return parameters, {"lsd_dB": lsd, "floor_dB": floor, "excess_over_floor": round(float(value / floor), 2)}


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
                print(f"{effect:26s} {amount:10.4g} {found['excess_over_floor']:6.2f} {found} {parameters}", flush=True)
