"""The strength of amounts of the effects, for choosing the ranges of amounts.py.

Strength is excess over floor on the hold-out record. All amounts share one force, the runs of the
bare rig and its floor, which is quick and approximate; a drawn campaign states its own.
"""

from functools import lru_cache

import numpy as np

from vibroimpact_truth.amounts import AMOUNTS
from vibroimpact_truth.campaign import (
    SAMPLING,
    TWINS,
    Plan,
    apply_instruments,
    forces,
    noise_rms,
    simulate_records,
)
from vibroimpact_truth.strength import excess


@lru_cache(maxsize=2)
def bare(seed, duration, tube):
    """(plan, force, noise, 2 TWINS hold-out responses) of the bare rig, the common reference."""
    plan = Plan(
        (seed,), tube=tube, duration=duration, levels=((0.5, 1.3, "fit"), (10.0, 0.9, "holdout"))
    )
    force = forces(plan)
    both = simulate_records(plan, force)[0]
    noise = noise_rms(plan, both)
    runs = [
        both[1:],
        *(
            simulate_records(plan, force, start_stream=k, only="holdout")[0]
            for k in range(1, 2 * TWINS)
        ),
    ]
    twins = [apply_instruments(plan, force[1:], run, noise, k)[1] for k, run in enumerate(runs)]
    return plan, force, noise, twins


def measure(effect, amount, seed, duration=20.0, tube="stand_in"):
    """(parameters, strength) of an amount of an effect, with the floor of the bare rig."""
    plan, force, noise, twins = bare(seed, duration, tube)
    parameters = AMOUNTS[effect].parameters(amount, np.random.default_rng([seed, 99]))
    hiding = Plan(
        plan.seed, ((effect, parameters),), tube=tube, duration=duration, levels=plan.levels
    )
    response = simulate_records(hiding, force, start_stream=9, only="holdout")[0]
    seen = apply_instruments(hiding, force[1:], response, noise, 9)[1]
    floor = excess(twins[0], twins[TWINS:], twins[1:TWINS], noise, SAMPLING)["floor_dB"]
    found = excess(seen, twins[:TWINS], twins[TWINS : 2 * TWINS - 1], noise, SAMPLING)
    return parameters, {
        "lsd_dB": found["lsd_dB"],
        "floor_dB": floor,
        "excess": round(float(np.sqrt(max(0.0, found["lsd_dB"] ** 2 - floor**2)) / floor), 2),
    }


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
                print(f"{effect:26s} {amount:10.4g} {found} {parameters}", flush=True)
