"""What may look like a leading explanation: other laws, other effects, other places."""

from dataclasses import replace

import numpy as np

from vibroimpact.effects.effect import Effect, Values
from vibroimpact.effects.places import ALONG, TURNED
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.linear_stage.candidates import (
    AT_A_POINT,
    DIRECTED,
    DIRECTION,
    Candidate,
    Pair,
    candidate_named,
    elsewhere,
    other_places,
)

from .first_points import first_points
from .search import Search

# from that of the force: close to it the response changes most, along it the motion is plane
DIRECTIONS_DEG = (-45.0, -15.0, -5.0, 5.0, 15.0, 45.0, 90.0)


def _similar(effect: Effect, leading: Effect) -> bool:
    """Return whether an Effect may look like a leading one."""
    return effect.family == leading.family or effect.id in leading.aliases


def is_like(search: Search, other: str, leading: Candidate) -> bool:
    """Return whether another effect that was run may look like a leading one."""
    candidate = candidate_named(other)
    return (
        _run_near(search, other, leading)
        and candidate.effect_id != leading.effect_id
        and _similar(candidate.effect, leading.effect)
    )


def _run_near(search: Search, other: str, leading: Candidate) -> bool:
    """Return whether one effect was run at the place of a leading one, or at that of the first
    runs.
    """
    trial = search.trials[other]
    return not isinstance(trial.candidate, Pair) and (
        trial.screened > 1 or trial.candidate.location == leading.location
    )


def laws_of(search: Search, name: str) -> list[str]:
    """Return the names of what was run of a leading explanation's family, at its place or at that
    of the first runs.
    """
    leading = candidate_named(name)
    return [
        other
        for other, trial in search.trials.items()
        if other in search.fits
        and _run_near(search, other, leading)
        and trial.candidate.effect.family == leading.effect.family
    ]


def similar_too(search: Search, values: Values, name: str) -> bool:
    """Run what has a signature like a leading explanation's at as many first points as may be,
    return whether there is any: at two, a law may be as good as rigid, or do nothing. Where it
    leads at one support, what was run at all of them is run there.
    """
    leading = candidate_named(name)
    if isinstance(leading, Pair):
        return False
    found = _similar_there(search, values, leading)
    found += [
        other
        for other, trial in search.trials.items()
        if not trial.refined
        and _run_near(search, other, leading)
        and _similar(trial.candidate.effect, leading.effect)
    ]
    search.screen([search.first(other) for other in found])
    for other in found:
        search.fit(other)
    return bool(found)


def _similar_there(search, values, leading):
    """Return the names of what was run at all supports, is like what leads at one of them, and was
    not run there.
    """
    others = {trial.candidate for trial in search.trials.values() if _at_all(trial.candidate)}
    there = [
        replace(other, location=leading.location).name
        for other in sorted(others, key=lambda other: other.name)
        if _similar(other.effect, leading.effect)
        and leading.location != other.location
        and leading.location in other.effect.locations(values)
    ]
    return [name for name in there if name not in search.trials]


def _at_all(candidate):
    return not isinstance(candidate, Pair) and candidate.location == "all"


def elsewhere_too(search: Search, values: Values, name: str) -> bool:
    """Run a leading explanation at other places, return whether there are any: of an effect at a
    point the other points, or the place that mirrors it on a tube, whose ends are mostly alike; of
    one at all supports each of them alone.
    """
    candidate, unit = candidate_named(name), search.fits[name].unit
    if candidate.along:
        search.run([(name, np.append(unit[:-1], 1.0 - unit[-1]))])
        return True
    others = [*other_places(candidate, values), *elsewhere(candidate, values)]
    new = [other.name for other in others if other.name not in search.trials]
    search.run([(other, unit) for other in new])
    return bool(new)


def at_its_place(search: Search, name: str) -> bool:
    """Run every effect at a point, of those that were run elsewhere, where a leading one is found:
    a stop, a spring or a rubbing there may each look like another. Return whether it is one.
    """
    leading = candidate_named(name)
    if isinstance(leading, Pair) or leading.effect_id not in AT_A_POINT:
        return False
    run = {
        trial.candidate.effect_id
        for trial in search.trials.values()
        if "+" not in trial.candidate.name
    }
    for effect_id in sorted(run & (DIRECTED if leading.turned else AT_A_POINT)):
        other = replace(leading, effect_id=effect_id)
        if not leading.along:
            search.screen([search.first(other.name, 2 * len(other.effect.parameters))])
            search.fit(other.name)
        elif effect_id != leading.effect_id:
            there = first_points(other)[: 2 * len(EFFECTS[effect_id].parameters)]
            where = slice(len(EFFECTS[effect_id].parameters), None)
            there[:, where] = search.fits[name].unit[where.start - len(other.effect.parameters) :]
            search.run([(other.name, there)])
    return True


def turned_too(search: Search, name: str) -> bool:
    """Run a leading explanation of a tube in other directions than that of the force, return
    whether it acts in one: a spring or a stop may hold a tube in any direction across it.

    What was run along the force tells nothing of them: the motion stays in one plane there, and
    leaves it as soon as the direction does.
    """
    leading = candidate_named(name)
    if isinstance(leading, Pair) or leading.location != ALONG or leading.effect_id not in DIRECTED:
        return False
    other, unit = replace(leading, location=TURNED), search.fits[name].unit
    low, high = DIRECTION.low, DIRECTION.high
    turned = [(degrees - low) / (high - low) for degrees in DIRECTIONS_DEG]
    search.run([(other.name, np.array([np.insert(unit, -1, one) for one in turned]))])
    return True
