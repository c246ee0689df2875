"""What a job asks a cluster for.

Values in rules are those of the first attempt: a job that fails, for lack of memory or time, asks
for as much again with each attempt (`--retries`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def memory(first_MB: int) -> Callable[[Any, int], int]:
    """Return the memory of a job in MB, by its attempt.

    first_MB: covers the script and two Snakemake processes of about 160 MB each, which a job of
        a cluster has with it.
    """
    return lambda wildcards, attempt: first_MB * attempt


def minutes(first: int) -> Callable[[Any, int], int]:
    """Return the longest time that a job may take in minutes, by its attempt."""
    return lambda wildcards, attempt: first * attempt
