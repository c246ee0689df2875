"""Folders of results/ that targets of their own write: no study or campaign may have one."""

import re

TARGETS = ("validation",)
# Marks of a wildcard of snakemake, and names of no folder inside results/.
UNUSABLE = r"[{}/\\*?\x00-\x1f]|^\.*$"
DRAW_NAME = r"(acceptance|development)_([0-9]+)"  # of every draw of campaigns


def is_reserved(name: str) -> bool:
    """Whether a target writes to the folder of this name, or a draw of campaigns does.

    A file system may take Validation for validation.
    """
    return name.lower() in TARGETS or re.fullmatch(DRAW_NAME, name.lower()) is not None


def name_problem(name: str, study: str | None = None) -> str | None:
    """Return why results can not go to results/NAME, as the end of a sentence; None if they can.

    study: name of the study of the same run, whose folder is taken.
    """
    if is_reserved(name):
        target = name.lower() if name.lower() in TARGETS else "acceptance"
        return f"its results would go to results/{name}, which the target {target} writes"
    if name == study:
        return f"its results would go to results/{name}, the folder of the study '{study}'"
    if re.search(UNUSABLE, name):
        return f"'{name}' can not be the name of a folder of results"
    return None
