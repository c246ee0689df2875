"""Amounts that make an effect strong or medium on its own beam: short records beside the bare rig.

No search for effects takes part: the strength is the excess of band powers over their scatter
between starts (strength.py), on the largest record that is held out. The campaign states its own.
"""

from dataclasses import replace

import numpy as np

from evidence.truth.amounts import AMOUNTS
from evidence.truth.campaign import (
    apply_instruments,
    forces,
    judged_levels,
    noise_rms,
    simulate_records,
)
from evidence.truth.draw import POOLS, draw, hide
from evidence.truth.strength import audible_powers, band_powers, strength_by_channel

TARGETS = {"medium": (1.3, 2.6)}  # floors of excess
STRONG = (4.5, 12.0)
PROBE_S, TWINS, TRIES = 8.0, 3, 4
WIDE = 1.4  # a strength within this factor of its target will do
LEAST, MOST = 0.01, 10.0  # of the amount an effect starts from


def probe_of(plan):
    """The plan with one short record, of those its strength is judged on, without noise."""
    load, percent, _ = plan.levels[judged_levels(plan)[-1]]
    return replace(
        plan, levels=((load, percent, "holdout"),), duration=min(plan.duration, PROBE_S), noise=0.0
    )


class Probe:
    """Short records of the bare rig of a plan, to measure strengths against."""

    def __init__(self, plan):
        self.plan = replace(probe_of(plan), effects=())
        self.force = forces(self.plan)
        runs = [
            simulate_records(self.plan, self.force, start_stream=1 + k)[0] for k in range(TWINS)
        ]
        lowest = min(load for load, *_ in plan.levels) / self.plan.levels[0][0]
        self.noise = lowest * plan.noise / 0.01 * noise_rms(replace(self.plan, noise=0.01), runs[0])
        seen = np.array([self.seen(self.plan, run, k) for k, run in enumerate(runs)])
        self.bare = band_powers(seen, plan.sampling, plan.band)

    def seen(self, plan, response, stream):
        """(record, channel, time) as measured."""
        return apply_instruments(plan, self.force, response, self.noise, stream)[1]

    def strength(self, plan):
        """Floors of excess of a plan's effects; infinite where the rig breaks."""
        plan = replace(probe_of(plan), effects=plan.effects)
        try:
            response = simulate_records(plan, self.force, start_stream=9)[0]
        except FloatingPointError:
            return np.inf
        seen = band_powers(self.seen(plan, response, 9), plan.sampling, plan.band)
        return strength_by_channel(
            seen, self.bare, self.bare, audible_powers(self.noise, plan.sampling, plan.band)
        )


def tuned(pool, seed, number):
    """The Plan of a campaign of a draw, with effects of a strength that its kind asks for."""
    plan, size, names = draw(pool, seed, number)
    if plan.kind == "fault" or not any(name in AMOUNTS for name in names):
        return plan
    probe, amounts = Probe(plan), []
    for place, name in enumerate(names):
        rng = np.random.default_rng([seed, number, POOLS.index(pool), 13, place])
        target = float(np.exp(rng.uniform(*np.log(TARGETS.get(plan.kind, STRONG)))))

        def alone(amount, place=place):
            """The plan with this one of its effects, and its strength."""
            whole = [amount if k == place else 1.0 for k in range(len(names))]
            one = hide(plan, size, pool, names, whole)
            return probe.strength(replace(one, effects=(one.effects[place],)))

        tune = name in AMOUNTS and AMOUNTS[name].tuned
        amounts.append(amount_for(target, alone) if tune else 1.0)
    return hide(plan, size, pool, names, amounts)


def amount_for(target, strength):
    """The amount whose strength (a function of it) comes nearest to the target, of TRIES."""
    amount, tried = 1.0, []
    for _ in range(TRIES):
        found = strength(amount)
        tried.append((abs(np.log(max(found, 1e-3) / target)), amount))
        if target / WIDE < found < target * WIDE:
            return amount
        step = 0.5 if not np.isfinite(found) else float(np.clip(target / max(found, 1e-3), 0.2, 4))
        amount = float(np.clip(amount * step, LEAST, MOST))
    return min(tried)[1]
