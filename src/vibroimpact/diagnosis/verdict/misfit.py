"""Distances of model and measurement in dB: their excess over chance, the share that a completion
closes, and the text in place of a model that is not better.

closed_fraction is the only definition of that share.
"""

from collections.abc import Mapping
from typing import Any

from vibroimpact.effects.registry import effects_in_words

NO_EXCESS = 0.5  # of the floor: a smaller excess is no information


def excess(distance: float, floor: float) -> float:
    """Return the root of the squared distance less the squared floor in dB; 0 below the floor."""
    return max(0.0, distance**2 - floor**2) ** 0.5


def closed_fraction(
    before: float, after: float, floor: float, floor_before: float | None = None
) -> float | None:
    """Return 1 - excess after / excess before of distances in dB; None if the excess before is
    negligible: then the records hold no information on the addition.

    floor, floor_before: dB, of the model after and before, the same if None.
    """
    given = floor if floor_before is None else floor_before
    first = excess(before, given)
    return None if first <= NO_EXCESS * given else 1.0 - excess(after, floor) / first


def makes_worse(row: Mapping[str, Any]) -> bool:
    """Return whether the misfit {before_dB, after_dB, floor_dB} with the completed model is larger
    than before, and than its floor, by more than chance.
    """
    before, after, floor = (row[f"{key}_dB"] for key in ("before", "after", "floor"))
    return after is not None and excess(after, max(before, floor)) > NO_EXCESS * floor


def not_offered(withdrawn: Mapping[str, Any]) -> str:
    """Return the text in place of a completed configuration that is not better than the given one;
    withdrawn: values of content.Withdrawn.
    """
    effects = effects_in_words(row["id"] for row in withdrawn["effects"])
    splits = {
        "the records that took no part": withdrawn["misfit"]["holdout"],
        "the records that it was fitted to, run anew,": withdrawn["misfit"]["fit"],
    }
    known = {name: row for name, row in splits.items() if row and row["before_dB"] is not None}
    farther = {name: row for name, row in known.items() if makes_worse(row)}
    records, misfit = next(iter((farther or known).items()))
    return (
        f"# No model is offered: {effects} was added, and {records} are\n"
        f"# {'farther off' if farther else 'still off'} with it,"
        f" {misfit['before_dB']:.2f} dB before and {misfit['after_dB']:.2f} dB after.\n"
    )
