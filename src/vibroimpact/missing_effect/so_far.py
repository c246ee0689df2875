"""What is known while the search goes on: whether anything is missing, where, and which effects are
left.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.observation.signals import Signals
from vibroimpact.records import plain_values, write_text

from . import constants
from .null import Null
from .probabilities import posterior
from .search import Search

WORST = 5  # places that are told


def write(folder: Path, search: Search, prepared: Prepared) -> None:
    """Write so_far.json of a Search into the folder."""
    null = search.null
    content = {
        "probability_by_chance": null.plain.probability(),
        "lowest_record": None if prepared.adopted is None else prepared.adopted["name"],
        "where": where(null, search.bench.signals),
        "effects": [],
    }
    if search.fits:
        chances = posterior(search)
        told = prepared.adopted is not None  # by the lowest record: "nothing" is that no more is
        content["probability_none"] = 0.0 if told else np.exp(chances["nothing"])
        content["probability_something_else"] = np.exp(chances["something else"])
        content["effects"] = [
            {"ids": list(ids), "probability": chance} for ids, chance in by_effect(chances)
        ]
    write_text(json.dumps(plain_values(content), indent=1), folder / "so_far.json")


def write_refusal(folder: Path, prepared: Prepared) -> None:
    """Write so_far.json of a campaign that can not be tested into the folder: the sentence why."""
    write_text(json.dumps({"refused": prepared.refusal}, indent=1), folder / "so_far.json")


def by_effect(chances: dict[str, float]) -> list[tuple[tuple[str, ...], float]]:
    """Return [(ids, probability)] of {name: log probability}, the most probable first."""
    out: dict[tuple[str, ...], float] = {}
    for name, chance in chances.items():
        if name not in ("nothing", "something else"):
            ids = tuple(sorted(candidate_named(name.removesuffix(constants.ELSE)).ids))
            out[ids] = out.get(ids, 0.0) + float(np.exp(chance))
    return sorted(out.items(), key=lambda row: -row[1])


def where(null: Null, signals: Signals) -> list[dict[str, Any]]:
    """Return the rows of channels and records that are farthest off, in sigmas of a feature."""
    whole = null.measured.reshape(len(null.records), -1)
    rows = [
        {
            "record": signals.record_names[record],
            "channel": name,
            "rms_z": float(np.sqrt(np.mean(row[null.layout.channel == channel] ** 2))),
        }
        for record, row in zip(null.records, whole, strict=True)
        for channel, name in enumerate(signals.names)
    ]
    return sorted(rows, key=lambda row: -row["rms_z"])[:WORST]
