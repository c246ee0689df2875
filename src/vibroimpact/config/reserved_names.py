"""Folders of results/ that targets of their own use: no study, campaign or import may have one."""

from __future__ import annotations

import re
from collections.abc import Iterable

TARGETS = ("suite_check", "validation")  # each writes to the folder of its name
SUITES = r"suite_[0-9]+(_[0-9]+s)?(_draw[0-9]+)?"
# How snakemake marks a wildcard, and what names no folder inside results/.
UNUSABLE = r"[{}/\\*?\x00-\x1f]|^\.*$"


def reserved_result_folders(examples: Iterable[str] = ()) -> tuple[str, ...]:
    """Return the names of folders in results/ that targets of their own use.

    examples: names of the folders of examples, each of which is a target.

    Folders of suites follow a pattern, which target_of knows.
    """
    return (*TARGETS, *examples)


def target_of(name: str, examples: Iterable[str] = ()) -> str | None:
    """Return the target whose results the folder results/NAME holds, None for a free name."""
    if name in reserved_result_folders(examples):
        return name
    return "suite" if re.fullmatch(SUITES, name) else None


def name_problem(name: str, examples: Iterable[str] = (), study: str | None = None) -> str | None:
    """Return why results can not go to results/NAME, as the end of a sentence; None where they can.

    examples: as in reserved_result_folders.
    study: name of the study of the same run, whose folder is taken.
    """
    target = target_of(name, examples)
    if target is not None:
        return f"its results would go to results/{name}, which the target {target} writes"
    if name == study:
        return f"its results would go to results/{name}, where the study '{study}' is"
    if re.search(UNUSABLE, name):
        return f"'{name}' can not be the name of a folder of results"
    return None
