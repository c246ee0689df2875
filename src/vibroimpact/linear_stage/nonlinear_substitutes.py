"""Nonlinear effects that may explain the lowest record instead of an adopted linear one: those at
points where a spring and a dashpot explain it as well.

A record with a linear response shows of an effect at a point, whatever its law, the equivalent
stiffness and damping at that load (statistical linearisation: J.B. Roberts, P.D. Spanos, Random
Vibration and Statistical Linearization, Wiley, 1990, chapter 4). What no spring and dashpot at a
point explain, no effect there explains: such an effect is not simulated instead of the adopted one.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import optimize

from vibroimpact.config.reading import check_config
from vibroimpact.effects import places
from vibroimpact.observation.attached_model import attach

from . import nuisance as linear
from .candidates import Candidate
from .effect_fit import LinearChanges
from .linearised import linearised
from .workbench import Workbench

LEAST_SHARE = 0.5  # of the gain of what was adopted: at the right place it is all of it
# of the tube's own stiffness: below it a spring is searched linearly, above it in its logarithm
SMALL = 0.01
# arsinh of the stiffness, ln of the damping, in units of the small one's
GRID = (np.linspace(-5.0, 9.0, 15), (-9.0, -5.0, -2.0))
SEARCHED = 80  # evaluations at most, from the best point of the grid


def in_place(
    bench: Workbench, candidates: Sequence[Candidate], gain: float, stiffness: float
) -> list[str]:
    """Return the names of the Candidates that may explain the lowest record of a Workbench instead
    of the adopted linear effect.

    bench: of the bare model, with the measured fit of its modes; gain: of log likelihood, of what
    was adopted; stiffness: scale in N/m.

    An effect that is screened at some points represents the points nearest to each. One whose place
    is a parameter is kept where any point is possible, one that acts all along the structure
    always.
    """
    acting = [candidate for candidate in candidates if candidate.effect.below_contact]
    at = {
        name: np.array(bench.values["points"][name])
        for name in places.masses_and_springs(bench.values)
    }
    if not any(candidate.location in {*at, places.ALONG} for candidate in acting):
        return [candidate.name for candidate in acting]
    changes = LinearChanges(bench)
    enough = [
        name for name in at if gain_of_spring(bench, changes, name, stiffness) > LEAST_SHARE * gain
    ]
    kept = []
    for candidate in acting:
        if candidate.location == places.ALONG:
            kept += [candidate.name] if enough else []
            continue
        own = [other.location for other in acting if other.effect_id == candidate.effect_id]
        if candidate.location not in at or candidate.location in {
            _nearest(own, at, name) for name in enough
        }:
            kept.append(candidate.name)
    return kept


def _nearest(own, at, name):
    """Return the one of the points `own` that is nearest to a point; at: {name: (3,) m}."""
    return min(own, key=lambda place: np.linalg.norm(at[place] - at[name]))


def gain_of_spring(bench: Workbench, changes: LinearChanges, place: str, stiffness: float) -> float:
    """Return the gain in log likelihood of the lowest record by the best spring, of positive or
    negative stiffness, and dashpot between a named point and the ground.

    changes: LinearChanges of the Workbench; stiffness: scale in N/m.
    """
    element = places.with_element(
        changes.values,
        "equivalent",
        place,
        places.across(changes.values, place),
        stiffness_N_per_m=1.0,
    )
    model = attach(check_config(element, "variant of the model"), bench.campaign)
    damping = SMALL * stiffness / model.omega[model.omega > 0.0][0]
    start = linear.reading_of_model(bench.bare, changes.modes)
    bare = linear.likelihood(bench.measured_reading, start)[0]

    def loss(unit):
        laws = replace(
            model.local_laws,
            stiffness=_last(model.local_laws.stiffness, SMALL * stiffness * np.sinh(unit[0])),
            damping=_last(model.local_laws.damping, damping * np.exp(unit[1])),
        )
        changed = linearised(replace(model, local_laws=laws))
        if np.sum(changed.omega > 0.0) < np.sum(model.omega > 0.0):
            return np.inf  # the negative stiffness makes the structure unstable
        reading = changes.reading_of(changed)
        return bare - linear.likelihood(bench.measured_reading, reading, start)[0]

    best = min(((first, second) for first in GRID[0] for second in GRID[1]), key=loss)
    return -float(
        optimize.minimize(
            loss,
            best,
            method="Nelder-Mead",
            options={"xatol": 0.01, "fatol": 0.3, "maxfev": SEARCHED},
        ).fun
    )


def _last(values, value):
    """Return values (n,) with the last one replaced."""
    return np.append(values[:-1], value)
