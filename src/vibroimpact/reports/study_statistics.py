"""The contact, wear, stress and energy of a study: medians and ranges over seeds.

They are taken from the records of its cases.
"""

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
    "impact_velocity_rms",
    "rms_force",
    "peak_force",
    "wear_work_rate",
    "sliding_work",
)
ELEMENT_QUANTITIES = ("element_power", "slip_power", "slip_work")
STRESSES = ("stress_rms", "stress_peak")
RESIDUALS = {
    # variable of a record -> what closes the energy balance
    "potential_energy_residual": "with the contact's potential energy",
    "energy_residual": "with the work of the contact forces",
    "fixed_point_residual": "contact iteration (bound)",
}
READ = (*SUPPORT_QUANTITIES, *ELEMENT_QUANTITIES, *STRESSES, "stress_flag", *RESIDUALS)
# Places: the largest value over supports or sections of a case; the values of each of them.
SEVERAL, EACH = "all", "each"


class Spread(NamedTuple):
    """Median, smallest and largest value over seeds, SI; NaN if there is none."""

    median: float
    low: float
    high: float


class CaseValue(NamedTuple):
    """A value of a case, the largest over its supports or sections, with the place of the case."""

    value: float
    gap_m: float
    load_rms_N: float
    seed: int


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
        # {(quantity, gap, load): {seed: {name of a support or section: value}}}
        self._values: dict[tuple, dict[int, dict[str, float]]] = {}
        for row in rows:
            if not math.isnan(row["value"]):
                key = row["quantity"], row["gap_m"], row["load_rms_N"]
                by_seed = self._values.setdefault(key, {})
                by_seed.setdefault(row["seed"], {})[row["of"]] = row["value"]

    def values(self, quantity: str, gap_m: float, load_rms_N: float, place: str) -> list[float]:
        """Return the values of a quantity over seeds.

        place: name of a support or section, empty for a quantity of the whole case, SEVERAL for the
        largest over all of them, EACH for those of all of them.
        """
        cases = self._values.get((quantity, gap_m, load_rms_N), {}).values()
        if place == SEVERAL:
            return [max(case.values()) for case in cases]
        return [value for case in cases for of, value in case.items() if place in (of, EACH)]

    def spread(self, quantity: str, gap_m: float, load_rms_N: float, place: str) -> Spread:
        """Return the Spread of values, see there, over seeds."""
        values = self.values(quantity, gap_m, load_rms_N, place)
        finite = [value for value in values if math.isfinite(value)]
        if not finite:
            return Spread(math.nan, math.nan, math.nan)
        return Spread(float(np.median(finite)), min(finite), max(finite))

    def of_cases(self, quantity: str) -> list[CaseValue]:
        """Return the CaseValues of a quantity, those of the largest value first."""
        found = [
            CaseValue(max(values.values()), gap, load, seed)
            for (name, gap, load), by_seed in self._values.items()
            for seed, values in by_seed.items()
            if name == quantity
        ]
        return sorted(found, reverse=True)

    def largest(self, quantity: str) -> CaseValue:
        """Return the largest value of a quantity with its case; NaN for none."""
        return next(iter(self.of_cases(quantity)), CaseValue(math.nan, math.nan, math.nan, 0))

    def open_balances(self) -> list[tuple[float, float, float]]:
        """Return (worst residual, gap in m, load), worst first, of each gap and load with a seed
        whose energy balance is open beyond ENERGY_LIMIT.
        """
        found = [case for name in ENERGY_RESIDUALS for case in self.of_cases(name)]
        worst: dict[tuple[float, float], float] = {}
        for value, gap, load, _ in sorted(found, reverse=True):
            if value > ENERGY_LIMIT:
                worst.setdefault((gap, load), value)
        return [(value, *place) for place, value in worst.items()]

    def flagged(self) -> list[tuple[float, float]]:
        """Return (gap in m, load) of the cases with a seed above the stress limit."""
        places = {(-gap, load) for value, gap, load, _ in self.of_cases("stress_flag") if value > 0}
        return [(-gap, load) for gap, load in sorted(places)]


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
