"""Completed models as plain values, for the JSON files between the steps of the workflow."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from vibroimpact.campaign.file import read_campaign, write_campaign
from vibroimpact.records import plain_values, read_json, write_text
from vibroimpact.reduction.modal_structure import IdentifiedModes

from .trial import Term, Trial


def modes_values(modes):
    """Return a dict of lists of IdentifiedModes."""
    return plain_values(asdict(modes))


def modes_of(values):
    """Return the IdentifiedModes of modes_values."""
    arrays = {
        name: np.array(values[name], bool if name == "residual" else float)
        for name in ("frequency", "damping_ratio", "shapes", "residual")
    }
    return IdentifiedModes(
        **arrays,
        drive=int(values["drive"]),
        kinds=tuple(values["kinds"]),
        names=tuple(values["names"]),
    )


def trial_values(trial):
    """Return a dict of plain values of a Trial."""
    return {
        "modes": modes_values(trial.modes),
        "terms": [plain_values(asdict(term)) for term in trial.terms],
        "offsets": plain_values(trial.offsets),
    }


def trial_of(values):
    """Return the Trial of trial_values."""
    terms = tuple(
        Term(
            each["law"],
            each["place"],
            None if each["row"] is None else tuple(each["row"]),
            np.array(each["values"], float),
            None if each["participation"] is None else np.array(each["participation"], float),
        )
        for each in values["terms"]
    )
    return Trial(modes_of(values["modes"]), terms, dict(values["offsets"]))


def write_values(values, path):
    """Write plain values as JSON; numbers that are not finite become null."""
    write_text(json.dumps(plain_values(values), indent=1, allow_nan=False) + "\n", path)


def read_values(path):
    """Return the values of a JSON file."""
    return read_json(path)


def write_kept(campaign, path):
    """Write the usable records of a campaign; an empty file where there are none (None)."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).touch() if campaign is None else write_campaign(campaign, path)


def read_kept(path):
    """Return the usable records of a campaign, None where there are none."""
    return read_campaign(path) if Path(path).stat().st_size else None
