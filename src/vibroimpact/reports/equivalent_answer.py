"""The answer of a study, read from its tables: recommended k and c by gap, load, group, direction.

k (N/m) and c (N s/m) are per support. A value that is not resolved is NaN and has a reason.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibroimpact.identify.method_names import method_name
from vibroimpact.study.reasons import NOT_MOVED

# The methods whose agreement is judged, by quantity: a shape carries no damping.
COMPARED = {"k": ("lscf", "ods", "broadband"), "c": ("lscf", "broadband")}
AGREEMENT = 0.25  # largest relative distance from the median
ALL_SUPPORTS = "all"
UNITS = {"k": "N_per_m", "c": "N_s_per_m"}


@dataclass(frozen=True)
class Value:
    """A recommended value with its interval over seeds.

    value, low, high: N/m or N s/m; NaN where not resolved.
    agreement: agree, spread or unresolved.
    reason: why it is not resolved, or what else is to be known; empty for nothing.
    """

    value: float
    low: float
    high: float
    agreement: str
    reason: str = ""

    @property
    def resolved(self) -> bool:
        """Whether there is a value."""
        return math.isfinite(self.value)


@dataclass(frozen=True)
class Answer:
    """The equivalent support of one gap (m), load (N RMS), group of supports and direction."""

    gap_m: float
    load_rms_N: float
    group: str
    direction: str
    k: Value
    c: Value

    @property
    def place(self) -> tuple[float, str, str]:
        """The curve that the answer belongs to: (gap, group, direction)."""
        return self.gap_m, self.group, self.direction


def with_places(rows: Iterable[dict], direction: str) -> list[dict]:
    """Return table rows with a group and a direction, both texts.

    direction: of rows without; tables of one group may have neither column, or leave it empty.
    """
    default = {"group": ALL_SUPPORTS, "direction": direction}
    return [
        row | {key: str(row.get(key, "")) or value for key, value in default.items()}
        for row in rows
    ]


def answers(
    summary: Sequence[dict], equivalent: Sequence[dict] | None, direction: str
) -> list[Answer]:
    """Return the Answers, ordered by gap (largest first), group, direction and load.

    Directions that the force does not move are left out: see unmoved.

    summary: rows of consistency_summary.csv.
    equivalent: rows of equivalent.csv; None where there is no such table. The recommended value is
    then the median of the compared methods.
    direction: that of rows without, such as y.
    """
    if equivalent is None:
        found = _from_summary(with_places(summary, direction))
    else:
        moved = [row for row in equivalent if row["reason_k"] != NOT_MOVED]
        found = [_from_equivalent(row) for row in with_places(moved, direction)]
    return sorted(found, key=lambda row: (-row.gap_m, row.group, row.direction, row.load_rms_N))


def unmoved(equivalent: Sequence[dict] | None) -> list[tuple[str, str]]:
    """Return (group, direction) of the supports that the force does not move, each once.

    equivalent: rows of equivalent.csv; None where there is no such table.
    """
    still = [row for row in equivalent or () if row["reason_k"] == NOT_MOVED]
    return list(dict.fromkeys((str(row["group"]), str(row["direction"])) for row in still))


def _from_equivalent(row: dict[str, Any]) -> Answer:
    def value(quantity):
        return Value(
            _number(row[f"{quantity}_{UNITS[quantity]}"]),
            _number(row[f"{quantity}_low"]),
            _number(row[f"{quantity}_high"]),
            str(row[f"agreement_{quantity}"]),
            _text(row[f"reason_{quantity}"]),
        )

    place = float(row["gap_m"]), float(row["load_rms_N"]), row["group"], row["direction"]
    return Answer(*place, value("k"), value("c"))


def _from_summary(rows: list[dict]) -> list[Answer]:
    """Return the Answers of a summary without recommended values: medians of the methods."""
    places: dict[tuple, dict[str, dict]] = {}
    for row in rows:
        key = float(row["gap_m"]), float(row["load_rms_N"]), row["group"], row["direction"]
        places.setdefault(key, {})[row["method"]] = row
    return [
        Answer(*key, *(_median(methods, quantity) for quantity in ("k", "c")))
        for key, methods in places.items()
    ]


def _median(methods: dict[str, dict], quantity: str) -> Value:
    """Return the median of the compared methods, if all of them have a value."""
    columns = (f"{quantity}_median", f"{quantity}_low", f"{quantity}_high")
    rows = {
        name: [_number(methods[name][column]) for column in columns]
        for name in COMPARED[quantity]
        if name in methods
    }
    missing = [
        name for name in COMPARED[quantity] if not math.isfinite(rows.get(name, [math.nan])[0])
    ]
    if missing:
        names = " and ".join(method_name(name) for name in missing)
        return Value(math.nan, math.nan, math.nan, "unresolved", f"no value by {names}")
    middle, low, high = np.array([*rows.values()]).T
    centre = float(np.median(middle))
    near = bool(np.all(np.abs(middle - centre) <= AGREEMENT * abs(centre)))
    return Value(centre, float(low.min()), float(high.max()), "agree" if near else "spread")


def _number(value: Any) -> float:
    return float(value) if isinstance(value, (int, float)) else math.nan


def _text(value: Any) -> str:
    return value if isinstance(value, str) else ""
