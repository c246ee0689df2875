"""Rows of verdict.json: checks, places, effects with their parameters."""

from typing import Any

import numpy as np

from vibroimpact.effects.effect import Values
from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.linear_stage.scales import clearance

from .decision import Decision

SHOWN = 8  # linear effects
BOUND = 0.02  # of a searched range: an estimate nearer to its end is at a bound


def contract_checks(rows: list[Values]) -> list[Values]:
    """Return the rows of checks with the keys of the contract alone."""
    return [
        {key: row.get(key) for key in ("check", "level", "record", "channel", "message")}
        for row in rows
    ]


def where(name: str) -> str:
    """Return the location in a candidate's name, both of a pair's joined with a plus; with its law
    where the catalogue has several of one effect.
    """
    places = []
    for part in name.split("+"):
        candidate = candidate_named(part)
        places.append(
            candidate.location
            + (f", {candidate.effect_id.replace('_', ' ')}" if candidate.effect.law_of else "")
        )
    return "+".join(places)


def bounds(decision: Decision) -> list[Values]:
    """Return rows of checks for estimates at a bound of their range, which no angle has."""
    if decision.chosen is None:
        return []
    parameters = decision.chosen.candidate.effect.parameters
    return [
        {
            "check": "bounds",
            "level": "warn",
            "record": None,
            "channel": None,
            "message": (
                f"{parameter.name} of {decision.chosen.candidate.name} is at a bound of its range."
            ),
        }
        for value, parameter in zip(decision.chosen.unit, parameters, strict=True)
        if min(value, 1.0 - value) < BOUND and parameter.unit != "deg"
    ]


def effects_of(prepared: Prepared, decision: Decision, model: Any) -> list[Values]:
    """Return the rows of `effects` of verdict.json; model: the bare one, whose clearances a
    gap_factor multiplies.
    """
    found, rows = [], []
    if prepared.adopted is not None and not (
        decision.chosen is not None and decision.chosen.candidate.alone
    ):
        found.append(
            (
                candidate_named(prepared.adopted["name"]),
                np.array(prepared.adopted["unit"]),
                np.atleast_2d(prepared.adopted["interval"]),
            )
        )
    if decision.chosen is not None:
        found.append((decision.chosen.candidate, decision.chosen.unit, decision.chosen.interval))
    for whole, unit, interval in found:
        ends = zip(whole.parts(interval[:, 0]), whole.parts(interval[:, 1]), strict=True)
        for (candidate, own), ((_, low), (_, high)) in zip(whole.parts(unit), ends, strict=True):
            rows.append(
                _effect(candidate, own, np.stack([low, high], axis=1), prepared.scales, model)
            )
    return rows


def _effect(candidate, unit, interval, sizes, model):
    """Return {id, location, parameters: {name: {value, unit, low, high}}}."""
    estimate = candidate.estimate(unit, interval, sizes)
    parameters = {
        parameter.name: (
            dict(zip(("value", "low", "high"), estimate[parameter.name], strict=True))
            | {"unit": parameter.unit}
        )
        for parameter in candidate.effect.parameters
    }
    nominal = (
        clearance(model, sizes["gap"], candidate.location) if candidate.effect_id == "gap" else None
    )
    if nominal is not None:
        parameters["gap"] = {
            "unit": "m",
            **{key: nominal * parameters["gap_factor"][key] for key in ("value", "low", "high")},
        }
    return {
        "id": candidate.effect.reported,
        "family": candidate.effect.family,
        "location": candidate.located(unit, sizes),
        "parameters": parameters,
    }
