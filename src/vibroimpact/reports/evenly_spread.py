"""A few values of many, for what has room for a few."""

from collections.abc import Sequence


def spread_evenly(values: Sequence, most: int) -> list:
    """Return at most `most` of the values, both ends among them, evenly spaced in their order."""
    if len(values) <= most:
        return list(values)
    return [values[round(at * (len(values) - 1) / (most - 1))] for at in range(most)]
