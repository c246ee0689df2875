"""The answer of a study, read from its tables: recommended k and c by gap, load, group, direction.

k (N/m) and c (N s/m) are per support. A value that is not resolved is NaN and has a reason.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from vibroimpact.equivalent_support.answer import Span
from vibroimpact.study.equivalent_table import VALUES
from vibroimpact.study.method_agreement import by_place, compared_spans, place_of
from vibroimpact.study.reasons import NOT_MOVED

ALL_SUPPORTS = "all"


@dataclass(frozen=True)
class Value(Span):
    """A recommended value with its interval over seeds, in N/m or N s/m.

    agreement: one of method_agreement.VERDICTS.
    reason: why it is not resolved, or further remarks; empty for nothing.
    methods: medians of the compared methods that resolve it.
    """

    agreement: str = ""
    reason: str = ""
    methods: Mapping[str, float] = field(default_factory=dict)

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


def answers(summary: Sequence[dict], equivalent: Sequence[dict]) -> list[Answer]:
    """Return the Answers, ordered by gap (largest first), group, direction and load.

    Directions that the force does not move are left out: see unmoved.

    summary: rows of consistency_summary.csv. equivalent: rows of equivalent.csv.
    """
    methods = by_place(summary)
    found = [
        _answer(row, methods.get(place_of(row), {}))
        for row in equivalent
        if row["reason_k"] != NOT_MOVED
    ]
    return sorted(found, key=lambda row: (-row.gap_m, row.group, row.direction, row.load_rms_N))


def places_of(answers: Sequence[Answer]) -> tuple[list[float], list[tuple[str, str]]]:
    """Return (gaps in m, (group, direction) pairs), each once, in the order of the answers."""
    gaps = list(dict.fromkeys(row.gap_m for row in answers))
    return gaps, list(dict.fromkeys((row.group, row.direction) for row in answers))


def unmoved(equivalent: Sequence[dict]) -> list[tuple[str, str]]:
    """Return (group, direction) of the supports that the force does not move, each once.

    equivalent: rows of equivalent.csv.
    """
    still = [row for row in equivalent if row["reason_k"] == NOT_MOVED]
    return list(dict.fromkeys((row["group"], row["direction"]) for row in still))


def _answer(row: dict[str, Any], methods: dict[str, list[dict]]) -> Answer:
    """Return the Answer of a row of equivalent.csv; methods: {method: row of the summary}."""
    alone = {name: own for name, (own,) in methods.items()}

    def value(quantity):
        spans = compared_spans(alone, quantity, several=False)
        ends = (row[name] for name in (VALUES[quantity], f"{quantity}_low", f"{quantity}_high"))
        told = row[f"agreement_{quantity}"], row[f"reason_{quantity}"]
        medians = {name: span[0] for name, span in spans.items() if math.isfinite(span[0])}
        return Value(*ends, *told, medians)

    return Answer(*place_of(row), value("k"), value("c"), row["k_bound"], row["contact_fraction"])
