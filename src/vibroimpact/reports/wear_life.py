"""The wear life of a study in sentences and tables, as ranges over the laws of wear."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import Any

from vibroimpact.study.wear.life import WearRow, deepest, wear_rank

from .number_text import digits
from .study_tables import span
from .table import Table


def wear_sentences(rows: Sequence[WearRow], config: Any, unit: str) -> list[str]:
    """Return the deepest wear of a study in sentences, [] without wear. unit: of the load."""
    if not rows:
        return []
    worst = max(deepest(rows), key=wear_rank)
    first, years = worst[0], config.wear.years
    return [
        f"Deepest wear after {digits(years)} years: {_range(worst, 'depth_m', 1e6)} µm, "
        f"{_range(worst, 'wall_share', 100.0)} % of the wall, at land {first.land} of"
        f" {first.support}, {digits(first.load_rms_N)} {unit} RMS and a gap of"
        f" {digits(1e3 * first.gap_m)} mm. {digits(100.0 * config.wear.wall_limit)} % of the wall"
        f" is reached after {_range(worst, 'years_to_limit', 1.0)} years. The ranges are over"
        f" {len(worst)} laws of wear."
    ]


def wear_table(rows: Sequence[WearRow], gap_m: float, loads: Sequence[float], unit: str) -> Table:
    """Return the wear of one gap, a row per load, support and land, ranges over the laws."""
    columns = (
        f"load ({unit} RMS)",
        "support",
        "land",
        "wear work rate (mW)",
        "depth (µm)",
        "of the wall (%)",
        "years to the limit",
    )
    chosen = [row for row in rows if row.gap_m == gap_m and row.load_rms_N in loads]
    cells = []
    for (load, support, land), group in groupby(
        chosen, key=lambda row: (row.load_rms_N, row.support, row.land)
    ):
        own = list(group)
        cells.append(
            (
                digits(load),
                support,
                str(land),
                digits(1e3 * own[0].work_rate_W),
                _range(own, "depth_m", 1e6),
                _range(own, "wall_share", 100.0),
                _range(own, "years_to_limit", 1.0),
            )
        )
    return Table(columns, cells)


def _range(rows: Sequence[WearRow], name: str, factor: float) -> str:
    """Return the range of a field as text; a value that is never reached is "never"."""
    values = [factor * getattr(row, name) for row in rows]
    low, high = min(values), max(values)
    if math.isinf(high):
        return "never" if math.isinf(low) else f"at least {digits(low)}"
    return digits(low) if low == high else span(low, high)
