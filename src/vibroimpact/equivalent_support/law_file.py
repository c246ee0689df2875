"""The law that ships with the package: its origin, and its errors on other tubes.

displacement_law.json and its measured errors, displacement_law_errors.csv, are made by the target
`equivalent_law` of the workflow from the default study and from the tubes of
config/validation/other_tubes.yaml.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.io.records import plain_values, read_text

from .displacement_law import DisplacementLaw

LAW_FILE = Path(__file__).with_name("displacement_law.json")
# Regions of the level that the errors are given for: hardly touching, transition, rattling.
RATIOS = ("k_median", "k_low", "k_high", "c_median", "c_low", "c_high")
REGIONS = ((0.5, 1.5), (1.5, 6.0), (6.0, 30.0))


@dataclass(frozen=True)
class ShippedLaw:
    """A law with its measured errors.

    origin: of the law.
    errors: rows of law_errors.error_rows, ascending, the last one over all levels.
    """

    law: DisplacementLaw
    errors: tuple[dict[str, Any], ...]
    origin: dict[str, Any]

    def error_at(self, level: float) -> dict[str, float]:
        """Return the measured ratios of simulation to law at a level: k_median, k_low, k_high and
        those of c.

        They are interpolated in logarithms between the middles of the regions. The range from low
        to high includes 1, the tube of the fit.
        """
        regions = self.errors[:-1]
        middles = [0.5 * np.log(row["level_from"] * row["level_to"]) for row in regions]
        error = {
            name: float(
                np.exp(np.interp(np.log(level), middles, [np.log(row[name]) for row in regions]))
            )
            for name in RATIOS
        }
        for name in ("k", "c"):
            error[f"{name}_low"] = min(error[f"{name}_low"], 1.0)
            error[f"{name}_high"] = max(error[f"{name}_high"], 1.0)
        return error


def law_text(law: DisplacementLaw, errors: Sequence[dict[str, Any]], origin: dict[str, Any]) -> str:
    """Return the JSON text of a law, its errors and its origin; numbers with six digits."""
    content = {
        "what": "RMS displacement of the linear tube on its equivalent support over the gap (held)"
        " and loss factor c omega / k (loss), against that of the tube without supports (level)",
        "origin": origin,
        **{name: _six_digits(getattr(law, name)) for name in ("level", "held", "loss")},
        "errors": [{key: float(f"{value:.4g}") for key, value in row.items()} for row in errors],
    }
    return json.dumps(plain_values(content), indent=1) + "\n"


def _six_digits(values: np.ndarray) -> list[float]:
    return [float(f"{value:.6g}") for value in values]


@cache
def shipped_law(path: Path = LAW_FILE) -> ShippedLaw:
    """Return the law of a file of law_text; that of the package by default."""
    content = json.loads(read_text(path))
    arrays = {name: np.array(content[name]) for name in ("level", "held", "loss")}
    return ShippedLaw(DisplacementLaw(**arrays), tuple(content["errors"]), content["origin"])
