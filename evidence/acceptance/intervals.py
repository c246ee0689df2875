"""Intervals of shares."""

from __future__ import annotations

from scipy import stats


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Return (low, high), the 95 % interval of Wilson of a share, hits of count."""
    interval = stats.binomtest(int(hits), int(count)).proportion_ci(0.95, method="wilson")
    return float(interval.low), float(interval.high)
