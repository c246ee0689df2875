"""The law that ships with the package: its origin, and its errors on other tubes.

displacement_law.json and its measured errors, displacement_law_errors.csv, are made by the target
`equivalent_law` of the workflow from the default study and from the tubes of
config/validation/other_tubes.yaml.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.io.records import read_text

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


@cache
def shipped_law(path: Path = LAW_FILE) -> ShippedLaw:
    """Return the law of a file that the workflow makes; that of the package by default."""
    content = json.loads(read_text(path))
    arrays = {name: np.array(content[name]) for name in ("level", "held", "loss")}
    return ShippedLaw(DisplacementLaw(**arrays), tuple(content["errors"]), content["origin"])
