"""The names of folders in results/ that targets of the workflow write, and no study may have."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
TARGETS = ("validation", "suite_check")
SUITE = "suite_"  # begins the name of every suite of campaigns


def reserved_names() -> frozenset[str]:
    """Return the names, in small letters: a file system may take Validation for validation."""
    places = (PACKAGE / "share" / "examples", PACKAGE.parents[1] / "examples")
    examples = (rules.parent.name.lower() for place in places for rules in place.glob("*/*.smk"))
    return frozenset((*TARGETS, *examples))


def is_reserved(name: str) -> bool:
    """Whether a target writes to the folder of this name, or a suite of campaigns does."""
    return name.lower() in reserved_names() or name.lower().startswith(SUITE)
