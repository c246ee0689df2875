"""Folders of results/ that targets of their own use: no study, campaign or import may have one."""

from __future__ import annotations

import re

# {name of the folder: the target whose results it holds}.
FOLDERS = {
    "f16": "f16",
    "silverbox": "silverbox",
    "suite_check": "suite_check",
    "validation": "validation",
}
SUITES = re.compile(r"suite_[0-9]+(_[0-9]+s)?(_draw[0-9]+)?")
# How snakemake marks a wildcard, and what leaves the folder of results.
UNUSABLE = re.compile(r"[{}/\\*?\x00-\x1f]|^\.*$")


def reserved_result_folders() -> tuple[str, ...]:
    """Return the names of folders in results/ that targets of their own use.

    Folders of suites follow a pattern, see target_of.
    """
    return tuple(FOLDERS)


def target_of(name: str) -> str | None:
    """Return the target whose results the folder results/NAME holds, None for a free name."""
    return FOLDERS.get(name) or ("suite" if SUITES.fullmatch(name) else None)


def name_problem(name: str, study: str | None = None) -> str | None:
    """Return why results can not go to results/NAME, as the end of a sentence; None where they can.

    study: name of the study of the same run, whose folder is taken.
    """
    target = target_of(name)
    if target is not None:
        return f"its results would go to results/{name}, which the target {target} writes"
    if name == study:
        return f"its results would go to results/{name}, where the study '{study}' is"
    if UNUSABLE.search(name):
        return f"'{name}' can not be the name of a folder of results"
    return None
