"""How much of what is missing an explanation takes away."""


def share_explained(left: float, before: float, values: int) -> float:
    """Return the share of a chi-square beyond chance that an explanation takes away; 1 where there
    was none.
    """
    return 1.0 - max(0.0, left - values) / (before - values) if before > values else 1.0
