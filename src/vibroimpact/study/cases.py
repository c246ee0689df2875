"""The cases of a study: grid <-> case id.

An id is made of values, not of positions in a list: adding a load, gap or seed changes no other id.
All loads and gaps of a seed have the same force, scaled.
"""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

ID_PATTERN = re.compile(r"load_(?P<load>[^_]+)_gap_(?P<gap>[^_]+)_seed_(?P<seed>\d+)")
SIGNIFICANT_DIGITS = 6
# Cases of a job at most: minutes of work against the seconds that a job needs to start, and files
# that Snakemake handles at once.
CASES_PER_JOB = 1000
SEEDS_PER_JOB = 64  # the force of each seed is in memory
ROUND_OFF = 1e-9  # of a logarithm: a load on the edge of a bin is the lowest of its bin
FINEST = 2**20  # bins per decade: loads closer than this stay together


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
        load, gap = value_text(self.load_rms_N), value_text(self.gap_m)
        return f"load_{load}_gap_{gap}_seed_{self.seed}"


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


def cases_of_files(paths: Iterable[str | Path]) -> list[Case]:
    """Return the Case of each file that is named after one. Raises ValueError for another name."""
    return [case_from_id(Path(path).stem) for path in paths]


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


def batches(
    grid: Any, bins_per_decade: int, cases_per_job: int = CASES_PER_JOB
) -> dict[str, list[Case]]:
    """Return {name of a batch: its cases}, the cases of a job each, ascending in load.

    A decade of loads is cut into `bins_per_decade` bins at fixed places. The cases of a bin are a
    batch; one of more than `cases_per_job` is halved, and its halves again. Seeds are taken in
    blocks of SEEDS_PER_JOB. An added load or seed thus changes the batch that it falls into, and no
    other, and the number of jobs grows with the grid only if jobs would become too long.

    A batch is named after its lowest load, e.g. from_0.5, and with several blocks of seeds after
    its first seed too. Its cases are in the order of all_cases.
    """
    loads = load_values(grid)
    found: dict[str, list[Case]] = {}
    for first in range(0, grid.seeds, SEEDS_PER_JOB):
        seeds = range(first, min(first + SEEDS_PER_JOB, grid.seeds))
        most = max(cases_per_job // (len(grid.gap_m) * len(seeds)), 1)
        block = f"_seed_{first}" if grid.seeds > SEEDS_PER_JOB else ""
        for together in loads_by_bin(loads, bins_per_decade, most):
            name = f"from_{value_text(together[0])}{block}"
            found[name] = [
                Case(load, float(gap), seed)
                for load, gap, seed in product(together, grid.gap_m, seeds)
            ]
    return found


def loads_by_bin(loads: Sequence[float], bins_per_decade: int, most: int) -> list[list[float]]:
    """Return the loads of each bin, ascending; a bin of more than `most` loads is cut in halves.

    Bin n holds loads from 10^(n / bins_per_decade) N up to, not including, the next bin.
    """
    bins: dict[int, list[float]] = {}
    for load in sorted(loads):
        at = math.floor(bins_per_decade * math.log10(load) + ROUND_OFF)
        bins.setdefault(at, []).append(load)
    return [
        part
        for together in bins.values()
        for part in (
            [together]
            if len(together) <= most or bins_per_decade > FINEST
            else loads_by_bin(together, 2 * bins_per_decade, most)
        )
    ]


def nearest_loads(grid: Any, wanted: Sequence[float]) -> list[float]:
    """Return the loads of config.grid nearest in logarithm to those wanted, ascending, each once.

    wanted (load,): N RMS.
    """
    loads = np.array(load_values(grid))
    return sorted({float(loads[np.argmin(np.abs(np.log(loads / load)))]) for load in wanted})


def all_cases(grid: Any) -> list[Case]:
    """Return every Case of config.grid, ordered by load, then gap, then seed."""
    return [case for load in load_values(grid) for case in cases_of_load(grid, load)]


def cases_of_load(grid: Any, load_rms_N: float) -> list[Case]:
    """Return the cases of one load, which one simulation job integrates together.

    grid: only its gap_m and seeds are read.
    """
    return [
        Case(float(load_rms_N), float(gap), seed)
        for gap, seed in product(grid.gap_m, range(grid.seeds))
    ]
