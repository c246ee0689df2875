"""The wear of a study in sentences and tables: its life, as ranges over the laws of wear, and the
effect of centred obstacles.
"""

import math
from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np

from vibroimpact.identify.secant import SMALL_OFFSET
from vibroimpact.study.wear.life import WearRow, deepest, wear_rank

from .number_text import digits, range_text
from .table import Table, table_of


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
    chosen = [row for row in rows if row.gap_m == gap_m and row.load_rms_N in loads]
    cells = []
    for _, group in groupby(chosen, key=lambda row: (row.load_rms_N, row.support, row.land)):
        own = list(group)
        cells.append(
            {
                f"load ({unit} RMS)": digits(own[0].load_rms_N),
                "support": own[0].support,
                "land": own[0].land,
                "wear work rate (mW)": digits(1e3 * own[0].work_rate_W),
                "depth (µm)": _range(own, "depth_m", 1e6),
                "of the wall (%)": _range(own, "wall_share", 100.0),
                "years to the limit": _range(own, "years_to_limit", 1.0),
            }
        )
    return table_of(cells)


def _range(rows: Sequence[WearRow], name: str, factor: float) -> str:
    """Return the range of a field as text; a value that is never reached is "never"."""
    values = [factor * getattr(row, name) for row in rows]
    low, high = min(values), max(values)
    if math.isinf(high):
        return "never" if math.isinf(low) else f"at least {digits(low)}"
    return range_text(low, high)


def centred_sentence(imperfection: float, offset_m: Any, gap_m: float) -> str:
    """Return the effect of centred obstacles on the wear work rate, "" for obstacles off centre.

    imperfection: largest random offset over the gap. offset_m: stated offsets. gap_m: smallest gap.
    """
    if max(imperfection, np.abs(offset_m).max(initial=0.0) / gap_m) > SMALL_OFFSET:
        return ""
    return (
        f"The obstacles are centred to {digits(imperfection)} of the gap: while the motion stays in"
        " the plane of the force hardly anything slides, and once it leaves that plane the wear"
        " work rate rises by decades. A real tube is off centre: state supports.centre_offset_m"
        " if wear at low loads counts."
    )


def centred_in(config: Any) -> str:
    """Return centred_sentence of a configuration, "" if the structure is not a tube."""
    if config.structure.kind not in ("u_tube", "path"):
        return ""
    offsets = [np.ravel(support.centre_offset_m) for support in config.supports]
    offset_m = np.concatenate(offsets) if offsets else np.zeros(0)
    return centred_sentence(config.integration.imperfection, offset_m, min(config.grid.gap_m))
