"""Whether probabilities are right: what is said with 90 % must be true nine times in ten."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from .intervals import wilson
from .right_names import right_names

FEWEST = 10  # statements in a bin
EDGES = np.linspace(0.0, 1.0, 11)


def statements(verdict: dict[str, Any], truth: dict[str, Any]) -> list[tuple[float, bool]]:
    """Return (probability, whether it is true) of what a verdict states: nothing missing, something
    else, and every explanation of its ranking, or of its ambiguity set where the ranking has none.

    Of a hidden effect of strength 0, which changes nothing, it is true that nothing is missing.

    verdict, truth: contents of their files. Empty where the engine states no probability.
    """
    kind, whole = truth["kind"], right_names(truth)
    found = [
        (
            verdict.get("probability_none"),
            (kind in ("nothing", "fault") and not whole) or _does_nothing(truth),
        ),
        (verdict.get("probability_something_else"), kind == "out_of_catalogue"),
    ]
    ranked = [(row.get("probability"), sorted(row["ids"]) in whole) for row in verdict["ranking"]]
    if all(probability is None for probability, _ in ranked):
        ranked = [
            (probability, sorted(ids) in whole)
            for ids, probability in zip(
                verdict["ambiguity_set"], verdict.get("ambiguity_probability", ()), strict=False
            )
        ]
    return [
        (float(probability), bool(true))
        for probability, true in [*found, *ranked]
        if probability is not None
    ]


def _does_nothing(truth: dict[str, Any]) -> bool:
    """Return whether a hidden effect leaves no excess above the floor."""
    return (truth.get("strength") or {}).get("floors") == 0.0


def reliability(stated: Iterable[tuple[float, bool]]) -> list[dict[str, float]]:
    """Return rows {stated_low, stated_high, stated, true, low, high, statements} of the reliability
    curve: tenths of probability, joined upwards from 0 until each bin has FEWEST statements.

    stated: mean probability in the bin; true: share that is true, with its 95 % interval.
    """
    pairs = np.array(list(stated), float).reshape(-1, 2)
    bins = _joined(np.clip(np.digitize(pairs[:, 0], EDGES[1:-1]), 0, len(EDGES) - 2))
    rows = []
    for first, last in bins:
        inside = (pairs[:, 0] >= EDGES[first]) & (
            (pairs[:, 0] < EDGES[last]) | (last == len(EDGES) - 1)
        )
        hits, count = int(pairs[inside, 1].sum()), int(inside.sum())
        low, high = wilson(hits, count)
        rows.append(
            {
                "stated_low": float(EDGES[first]),
                "stated_high": float(EDGES[last]),
                "stated": float(pairs[inside, 0].mean()),
                "true": hits / count,
                "low": low,
                "high": high,
                "statements": count,
            }
        )
    return rows


def _joined(which):
    """Return [(first edge, last edge)] of bins with FEWEST members each; a rest joins the last."""
    counts = np.bincount(which, minlength=len(EDGES) - 1)
    bins, first, held = [], 0, 0
    for number, count in enumerate(counts):
        held += count
        if held >= FEWEST:
            bins.append((first, number + 1))
            first, held = number + 1, 0
    if bins and first < len(counts):
        bins[-1] = (bins[-1][0], len(counts))
    return bins


def calibration_error(stated: Iterable[tuple[float, bool]]) -> float:
    """Return the expected calibration error: the mean over statements of |stated - true| of their
    bin; NaN without statements.

    Source: M.P. Naeini, G.F. Cooper, M. Hauskrecht, AAAI (2015).
    """
    rows = reliability(stated)
    weight = np.array([row["statements"] for row in rows], float)
    gap = np.array([abs(row["stated"] - row["true"]) for row in rows])
    return float(np.sum(weight * gap) / weight.sum()) if rows else float("nan")


def largest_gap(rows: list[dict[str, float]]) -> float:
    """Return the largest difference of stated and true in a reliability curve, NaN without bins."""
    return max((abs(row["stated"] - row["true"]) for row in rows), default=float("nan"))
