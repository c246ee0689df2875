"""candidates/<name>.json: the parameters of every explanation that was run more than screened."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.records import plain_values, write_text

from .decision import Decision
from .evidence import Likelihoods
from .search import Search

POINTS = 41  # along a parameter
WRITTEN = 8


def write(search: Search, decision: Decision, folder: Path) -> None:
    """Write the files of the most probable explanations of a Search whose runs go beyond screening,
    WRITTEN of them.
    """
    folder.mkdir(parents=True, exist_ok=True)
    trials = search.trials
    raced = [row for row in decision.rows if len(trials[row[0]].noise) > trials[row[0]].screened]
    for name, chance, _ in raced[:WRITTEN]:
        content = {
            "ids": trials[name].candidate.ids,
            "name": name,
            "gain": search.fits[name].log_evidence,
            "probability": chance,
            **parameters_of(search, name),
        }
        file = f"{name.replace('@', '_at_').replace('+', '_and_')}.json"
        write_text(json.dumps(plain_values(content), indent=1), folder / file)


def parameters_of(search: Search, name: str) -> dict[str, Any]:
    """Return {"profile": [...], "parameters": {...}} of an explanation."""
    trial = search.trials[name]
    emulator = search.emulator(name)
    unit, interval = search.estimate(name)
    profile, parameters, first = [], {}, 0
    parts = trial.candidate.parts(unit)
    for candidate, own in parts:
        inside = slice(first, first + len(own))
        estimate = candidate.estimate(own, interval[inside], search.scales)
        run = [candidate.physical(place, search.scales) for place in trial.unit[:, inside]]
        for number, parameter in enumerate(candidate.effect.parameters):
            units = np.repeat(unit[None], POINTS, axis=0)
            units[:, first + number] = np.linspace(0.0, 1.0, POINTS)
            left = Likelihoods.of(emulator, units, search.null).expected
            prefix = "" if len(parts) == 1 else f"{candidate.effect.reported}."
            profile.append(
                {
                    "parameter": prefix + parameter.name,
                    "unit": parameter.unit,
                    "log": parameter.log,
                    "values": [
                        candidate.physical(place, search.scales)[parameter.name]
                        for place in units[:, inside]
                    ],
                    "left": (left / search.null.values).tolist(),
                    "simulated": sorted({point[parameter.name] for point in run}),
                }
            )
            parameters[prefix + parameter.name] = dict(
                zip(("value", "low", "high"), estimate[parameter.name], strict=True)
            ) | {"unit": parameter.unit}
        first += len(own)
    return {"profile": profile, "parameters": parameters}
