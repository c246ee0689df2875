"""The answer of a study, read from its tables: recommended k and c by gap, load, group, direction.

k (N/m) and c (N s/m) are per support. A value that is not resolved is NaN and has a reason.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from vibroimpact.study import method_agreement
from vibroimpact.study.equivalent_table import equivalent_rows
from vibroimpact.study.reasons import NOT_MOVED

COMPARED = {"k": method_agreement.COMPARED, "c": method_agreement.COMPARED_DAMPING}
ALL_SUPPORTS = "all"
UNITS = {"k": "N_per_m", "c": "N_s_per_m"}


@dataclass(frozen=True)
class Value:
    """A recommended value with its interval over seeds.

    value, low, high: N/m or N s/m; NaN if not resolved.
    agreement: one of method_agreement.VERDICTS.
    reason: why it is not resolved, or further remarks; empty for nothing.
    methods: medians of the compared methods that resolve it.
    """

    value: float
    low: float
    high: float
    agreement: str
    reason: str = ""
    methods: Mapping[str, float] = field(default_factory=dict)

    @property
    def resolved(self) -> bool:
        """Whether there is a value."""
        return math.isfinite(self.value)

    @property
    def apart(self) -> float:
        """The largest relative distance of a method from the value; NaN for less than two."""
        if not self.resolved or len(self.methods) < 2:
            return math.nan
        return max(abs(value / self.value - 1.0) for value in self.methods.values())


@dataclass(frozen=True)
class Answer:
    """The equivalent support of one gap (m), load (N RMS), group of supports and direction.

    bound: N/m, the upper bound of k if it does not differ from 0; NaN otherwise.
    touching: share of time in contact; NaN if not known.
    """

    gap_m: float
    load_rms_N: float
    group: str
    direction: str
    k: Value
    c: Value
    bound: float = math.nan
    touching: float = math.nan

    @property
    def bounded(self) -> bool:
        """Whether the answer is an upper bound of k."""
        return math.isfinite(self.bound)

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
    equivalent: rows of equivalent.csv; None if there is no such table, which is then made of the
    summary.
    direction: that of rows without, such as y.
    """
    placed = with_places(summary, direction)
    rows = equivalent_rows(placed) if equivalent is None else with_places(equivalent, direction)
    methods: dict[tuple, dict[str, dict]] = {}
    for row in placed:
        methods.setdefault(_place(row), {})[row["method"]] = row
    found = [
        _answer(row, methods.get(_place(row), {})) for row in rows if row["reason_k"] != NOT_MOVED
    ]
    return sorted(found, key=lambda row: (-row.gap_m, row.group, row.direction, row.load_rms_N))


def places_of(answers: Sequence[Answer]) -> tuple[list[float], list[tuple[str, str]]]:
    """Return (gaps in m, (group, direction) pairs), each once, in the order of the answers."""
    gaps = list(dict.fromkeys(row.gap_m for row in answers))
    return gaps, list(dict.fromkeys((row.group, row.direction) for row in answers))


def _place(row: dict) -> tuple[float, float, str, str]:
    return float(row["gap_m"]), float(row["load_rms_N"]), row["group"], row["direction"]


def unmoved(equivalent: Sequence[dict] | None) -> list[tuple[str, str]]:
    """Return (group, direction) of the supports that the force does not move, each once.

    equivalent: rows of equivalent.csv; None if there is no such table.
    """
    still = [row for row in equivalent or () if row["reason_k"] == NOT_MOVED]
    return list(dict.fromkeys((str(row["group"]), str(row["direction"])) for row in still))


def _answer(row: dict[str, Any], methods: dict[str, dict]) -> Answer:
    """Return the Answer of a row of equivalent.csv; methods: {method: row of the summary}."""

    def value(quantity):
        medians = {
            name: number_or_nan(methods[name][f"{quantity}_median"])
            for name in COMPARED[quantity]
            if name in methods
        }
        return Value(
            number_or_nan(row[f"{quantity}_{UNITS[quantity]}"]),
            number_or_nan(row[f"{quantity}_low"]),
            number_or_nan(row[f"{quantity}_high"]),
            str(row[f"agreement_{quantity}"]),
            _text(row[f"reason_{quantity}"]),
            {name: median for name, median in medians.items() if math.isfinite(median)},
        )

    bound, touching = (number_or_nan(row.get(name)) for name in ("k_bound", "contact_fraction"))
    return Answer(*_place(row), value("k"), value("c"), bound, touching)


def number_or_nan(value: Any) -> float:
    """Return a cell of a table as a number, NaN if it is a text."""
    return float(value) if isinstance(value, (int, float)) else math.nan


def _text(value: Any) -> str:
    return value if isinstance(value, str) else ""
