"""The cases of a study: grid <-> case id.

An id is made of values, not of positions in a list: adding a load, gap or seed changes no other id.
All loads and gaps of a seed have the same force, scaled.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

ID_PATTERN = re.compile(r"load_(?P<load>[^_]+)_gap_(?P<gap>[^_]+)_seed_(?P<seed>\d+)")
SIGNIFICANT_DIGITS = 6


@dataclass(frozen=True, order=True)
class Case:
    """One simulation of the grid.

    load_rms_N: RMS of the force, N.
    gap_m: radial clearance, m.
    seed: index from 0.
    """

    load_rms_N: float
    gap_m: float
    seed: int

    def __str__(self) -> str:
        return f"load {self.load_rms_N:g} N RMS, gap {1e3 * self.gap_m:.4g} mm, seed {self.seed}"

    @property
    def id(self) -> str:
        """The name of the case's files, e.g. load_0.5_gap_0.00028886_seed_0."""
        return case_id(value_text(self.load_rms_N), self.gap_m, self.seed)


def case_id(load_text: str, gap_m: float, seed: int) -> str:
    """Return the id of a case; `load_text` may be a wildcard that stands for the load."""
    return f"load_{load_text}_gap_{value_text(gap_m)}_seed_{seed}"


def value_text(value: float) -> str:
    """Return the shortest text that reads back as exactly `value`.

    20.0 -> '20', 5.1106e-5 -> '5.1106e-05'.
    """
    text = repr(float(value))
    return text.removesuffix(".0")


def case_from_id(case_id: str) -> Case:
    """Return the Case of an id. Raises ValueError for other texts; the message shows an example."""
    match = ID_PATTERN.fullmatch(case_id)
    if match is None:
        raise ValueError(
            f"'{case_id}' is not a case id: it should look like load_0.5_gap_0.00028886_seed_0"
        )
    return Case(float(match["load"]), float(match["gap"]), int(match["seed"]))


def load_values(grid: Any) -> list[float]:
    """Return the loads (load,) in N RMS of config.grid.

    They are listed, or spaced evenly in logarithm and rounded to 6 significant digits. The
    rounding keeps ids short and exact.
    """
    loads = grid.load_rms_N
    if isinstance(loads, tuple):
        return [float(load) for load in loads]
    spaced = np.geomspace(loads.first, loads.last, loads.count)
    return [float(f"{load:.{SIGNIFICANT_DIGITS}g}") for load in spaced]


def loads_by_half_decade(grid: Any) -> dict[str, list[str]]:
    """Return {name of a half decade: texts of its loads}, both ascending.

    A half decade holds loads from 10^(n/2) N up to, not including, 10^((n+1)/2) N. It is named
    after its lower end, e.g. from_0.316. Batches made of half decades change only where a load is
    added.
    """
    batches: dict[int, list[float]] = {}
    for load in sorted(load_values(grid)):
        batches.setdefault(math.floor(2.0 * math.log10(load) + 1e-9), []).append(load)
    return {
        f"from_{10 ** (half / 2):.3g}": [value_text(load) for load in loads]
        for half, loads in batches.items()
    }


def nearest_loads(grid: Any, wanted: Sequence[float]) -> list[float]:
    """Return the loads of config.grid nearest in logarithm to those wanted, ascending, each once.

    wanted (load,): N RMS.
    """
    loads = np.array(load_values(grid))
    return sorted({float(loads[np.argmin(np.abs(np.log(loads / load)))]) for load in wanted})


def all_cases(grid: Any) -> list[Case]:
    """Return every Case of config.grid, ordered by load, then gap, then seed."""
    return [
        Case(load, float(gap), seed)
        for load, gap, seed in product(load_values(grid), grid.gap_m, range(grid.seeds))
    ]


def cases_of_load(grid: Any, load_rms_N: float) -> list[Case]:
    """Return the cases of one load, which one simulation job integrates together.

    grid: only its gap_m and seeds are read.
    """
    return [
        Case(float(load_rms_N), float(gap), seed)
        for gap, seed in product(grid.gap_m, range(grid.seeds))
    ]


def ids_of_load(grid: Any, load_text: str) -> list[str]:
    """Return the ids of the cases of one load, in the order of cases_of_load.

    load_text: of the load, or a wildcard that stands for it.
    """
    return [
        case_id(load_text, float(gap), seed) for gap, seed in product(grid.gap_m, range(grid.seeds))
    ]
