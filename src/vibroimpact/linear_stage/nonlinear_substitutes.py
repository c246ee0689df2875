"""Nonlinear effects that may explain the lowest record instead of an adopted linear one: those at
points where a spring and a dashpot explain it as well.

A record with a linear response shows of an effect at a point, whatever its law, the equivalent
stiffness and damping at that load (statistical linearisation: J.B. Roberts, P.D. Spanos, Random
Vibration and Statistical Linearization, Wiley, 1990, chapter 4). What no spring and dashpot at a
point explain, no effect there explains: such an effect is not simulated instead of the adopted one.
"""

from collections.abc import Sequence

import numpy as np

from vibroimpact.effects import places

from .candidates import Candidate
from .effect_fit import LinearChanges
from .spring_in_record import SpringInRecord
from .workbench import Workbench

LEAST_SHARE = 0.5  # of the gain of what was adopted: at the right place it is all of it


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
        name
        for name in at
        if SpringInRecord(bench, changes, name, stiffness).along_force().gain > LEAST_SHARE * gain
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
