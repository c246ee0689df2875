"""Values of a study between its loads, from one gap or from all gaps at equal load over gap."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, groupby
from operator import itemgetter
from typing import Any

import numpy as np

from .answer import Span

SAME = 1.0e-6  # relative difference below which two levels are the same


@dataclass(frozen=True)
class Reading:
    """A value read off a study at one level.

    span: value with its interval.
    bracket: the neighbouring levels, the nearest of all gaps.
    gaps: (gap,) m, sources of the value. blocked: gaps that reach the level, but are not resolved
        there.
    ratio: largest over smallest value of these gaps.
    rows: the rows that were interpolated, or that stood in the way.
    """

    span: Span
    bracket: tuple[float, float]
    gaps: tuple[float, ...]
    blocked: tuple[float, ...]
    ratio: float
    rows: tuple[dict[str, Any], ...]


def read_at(
    rows: Sequence[dict[str, Any]], level: float, columns: tuple[str, str, str], logarithmic: bool
) -> Reading:
    """Return the Reading of a level: linear in the logarithm of the level within each gap.

    A gap counts if the level lies between two of its loads that are both resolved. The value is
    the median over the gaps that count, and the interval the hull of theirs. It needs at least half
    of the gaps that reach the level; fewer would be a chance selection.

    rows: with the columns gap_m, level (such as the load over the gap) and those of `columns`:
        value, low and high; one per load and gap.
    logarithmic: interpolate the logarithm of the values, which then are positive.
    """
    found, brackets, gaps, used = [], [], [], []
    blocked: dict[float, list[dict[str, Any]]] = {}
    for gap in sorted({row["gap_m"] for row in rows}, reverse=True):
        ends = _neighbours([row for row in rows if row["gap_m"] == gap], level)
        if not ends:
            continue
        values = np.array([[row[column] for column in columns] for row in ends], dtype=float)
        if not np.all((values > (0.0 if logarithmic else -np.inf)) & np.isfinite(values)):
            blocked[float(gap)] = ends
            continue
        levels = [row["level"] for row in ends]
        found.append(_between(level, levels, values, logarithmic))
        brackets.append((levels[0], levels[-1]))
        gaps.append(float(gap))
        used += ends
    if len(found) < max(len(blocked), 1):
        rows_blocked = tuple(chain.from_iterable(blocked.values()))
        return Reading(Span(), (np.nan, np.nan), (), tuple(blocked), np.nan, rows_blocked)
    value, low, high = np.array(found).T
    middle = np.exp(np.median(np.log(value))) if logarithmic else np.median(value)
    return Reading(
        Span(float(middle), float(low.min()), float(high.max())),
        (max(brackets)[0], min(high for _, high in brackets)),
        tuple(gaps),
        tuple(blocked),
        float(value.max() / value.min()) if logarithmic else np.nan,
        tuple(used),
    )


def _neighbours(rows: Sequence[dict[str, Any]], level: float) -> list[dict[str, Any]]:
    """Return the row at a level, or the two that enclose it; none if it is outside."""
    ordered = sorted(rows, key=itemgetter("level"))
    same = [row for row in ordered if abs(row["level"] / level - 1.0) <= SAME]
    below = [row for row in ordered if row["level"] < level]
    above = [row for row in ordered if row["level"] > level]
    if same:
        return same[:1]
    return [below[-1], above[0]] if below and above else []


def _between(
    level: float, levels: Sequence[float], values: np.ndarray, logarithmic: bool
) -> np.ndarray:
    """Return (column,) values at a level, from one row or between two."""
    if len(levels) == 1:
        return values[0]
    share = np.log(level / levels[0]) / np.log(levels[1] / levels[0])
    if logarithmic:
        return np.exp((1.0 - share) * np.log(values[0]) + share * np.log(values[1]))
    return (1.0 - share) * values[0] + share * values[1]


def ranges_of_agreement(rows: Sequence[dict[str, Any]], column: str) -> list[tuple[float, float]]:
    """Return the ranges of level over which every row says "agree", lowest first."""
    runs = groupby(sorted(rows, key=itemgetter("level")), key=lambda row: row[column] == "agree")
    levels = [[row["level"] for row in run] for agrees, run in runs if agrees]
    return [(own[0], own[-1]) for own in levels]
