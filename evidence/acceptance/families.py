"""Families of effects, and whether a verdict names the right one.

The truth's laws that no model has belong to a family too. An engine may state the family of an
effect; where it does not, it is the one its id stands under here.
"""

from __future__ import annotations

from typing import Any

from evidence.truth.hidden import FAMILIES


def family_of(name: str) -> str:
    """Return the family of an effect or law, "" where it is of none."""
    return next((family for family, names in FAMILIES.items() if name in names), "")


def same_family(verdict: dict[str, Any], hidden: list[str]) -> bool:
    """Return whether all families of what is hidden are those of an explanation of a verdict.

    verdict: content of verdict.json. hidden: names of the truth.
    """
    wanted = {family_of(name) for name in hidden}
    if not hidden or "" in wanted:
        return False
    said = [{family_of(name) for name in row} for row in verdict["ambiguity_set"]]
    stated = {_plain(effect.get("family")) for effect in verdict["effects"]} - {""}
    return wanted in [*said, stated]


def _plain(family: str | None) -> str:
    """Return a family's name in the words of FAMILIES."""
    return (family or "").replace("_", " ").lower()
