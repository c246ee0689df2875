"""The share of a discrepancy that an explanation removes."""


def share_explained(left: float, before: float, values: int) -> float:
    """Return the share of the chi-square beyond chance that an explanation removes.

    left, before: chi-square with and without the explanation. values: its number of values, which
    is the chi-square by chance. The share is 1 where nothing was beyond chance before.
    """
    return 1.0 - max(0.0, left - values) / (before - values) if before > values else 1.0
