"""The contact, wear, stress and energy of a study: medians and ranges over seeds.

They are taken from the records of its cases.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vibroimpact.integration.energy_limit import ENERGY_LIMIT, ENERGY_RESIDUALS
from vibroimpact.study.cases import Case, case_from_id
from vibroimpact.study.statistics_table import statistics_rows

SUPPORT_QUANTITIES = (
    "contact_fraction",
    "impact_rate",
    "rms_force",
    "peak_force",
    "wear_work_rate",
    "sliding_work",
)
ELEMENT_QUANTITIES = ("element_power", "slip_power", "slip_work")
STRESSES = ("stress_rms", "stress_peak")
RESIDUALS = (*ENERGY_RESIDUALS, "fixed_point_residual")
READ = (*SUPPORT_QUANTITIES, *ELEMENT_QUANTITIES, *STRESSES, "stress_flag", *RESIDUALS)
SEVERAL = "all"  # the place of a largest value over supports, sections or the whole case


class Spread(NamedTuple):
    """Median, smallest and largest value over seeds, SI; NaN if there is none."""

    median: float
    low: float
    high: float


NOTHING = Spread(math.nan, math.nan, math.nan)


class StudyStatistics:
    """The statistics of all cases of a study.

    cases: of the study.
    rows: {load_rms_N, gap_m, seed, quantity, of, value} as statistics_rows gives them.

    Attributes: gaps (m, largest first), loads (N RMS, ascending), supports, elements and sections
    (names), quantities (those that have a value).
    """

    def __init__(self, cases: Sequence[Case], rows: Iterable[dict]):
        rows = list(rows)
        self.gaps = sorted({case.gap_m for case in cases}, reverse=True)
        self.loads = sorted({case.load_rms_N for case in cases})
        self.cases = len(cases)
        self.quantities = {row["quantity"] for row in rows}
        self.supports = _places(rows, SUPPORT_QUANTITIES)
        self.elements = _places(rows, ELEMENT_QUANTITIES)
        self.sections = _places(rows, STRESSES)
        self._values: dict[tuple, list[float]] = {}
        self._largest: dict[tuple, dict[int, float]] = {}
        for row in rows:
            key = row["quantity"], row["gap_m"], row["load_rms_N"]
            self._values.setdefault((*key, row["of"]), []).append(row["value"])
            by_seed = self._largest.setdefault(key, {})
            by_seed[row["seed"]] = max(by_seed.get(row["seed"], -math.inf), row["value"])

    def spread(self, quantity: str, gap_m: float, load_rms_N: float, place: str = "") -> Spread:
        """Return the Spread of a quantity over seeds.

        place: name of a support or section, empty for a quantity of the whole case, SEVERAL for the
        largest over all of them.
        """
        values = (
            [*self._largest.get((quantity, gap_m, load_rms_N), {}).values()]
            if place == SEVERAL
            else self._values.get((quantity, gap_m, load_rms_N, place), [])
        )
        finite = [value for value in values if math.isfinite(value)]
        if not finite:
            return NOTHING
        return Spread(float(np.median(finite)), min(finite), max(finite))

    def largest(self, quantity: str) -> tuple[float, float, float]:
        """Return (value, gap in m, load) of the largest value of a quantity; NaN for none."""
        found = [
            (max(by_seed.values()), gap, load)
            for (name, gap, load), by_seed in self._largest.items()
            if name == quantity
        ]
        return max(found, default=(math.nan, math.nan, math.nan))

    def open_balances(self) -> list[tuple[float, float, float]]:
        """Return (worst residual, gap in m, load), worst first, of each gap and load with a seed
        whose energy balance is open beyond ENERGY_LIMIT.
        """
        worst: dict[tuple[float, float], float] = {}
        for (name, gap, load), by_seed in self._largest.items():
            if name in ENERGY_RESIDUALS:
                values = [value for value in by_seed.values() if value > ENERGY_LIMIT]
                if values:
                    worst[gap, load] = max(worst.get((gap, load), 0.0), *values)
        return sorted(((value, *place) for place, value in worst.items()), reverse=True)

    def flagged(self) -> list[tuple[float, float]]:
        """Return (gap in m, load) of the cases with a seed above the stress limit."""
        return sorted(
            {
                (gap, load)
                for (name, gap, load), by_seed in self._largest.items()
                if name == "stress_flag" and max(by_seed.values()) > 0
            },
            key=lambda place: (-place[0], place[1]),
        )


def study_statistics(paths: Sequence[str | Path], read: Callable) -> StudyStatistics:
    """Return the statistics of record files, which are named after their cases.

    read: function (path, names) as records.read_record. Records of single steps have few of the
    quantities; those that are not there are left out.
    """
    present = set(read(paths[0])) if paths else set()
    names = [name for name in READ if name in present]
    return StudyStatistics(
        [case_from_id(Path(path).stem) for path in paths],
        (row for path in paths for row in statistics_rows(read(path, names))),
    )


def _places(rows: list[dict], quantities: Sequence[str]) -> list[str]:
    """Return the names of supports or sections, in the order of the records."""
    return list(dict.fromkeys(row["of"] for row in rows if row["quantity"] in quantities))
