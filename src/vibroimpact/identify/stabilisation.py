"""Stabilisation chart: poles that stay while the order of the estimator grows.

The pole of the main peak is chosen from it, or all poles of a band.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.linear.poles import frequency_of

from .lscf import NormalEquations

STABLE_FREQUENCY = 0.01  # largest relative change from one order to the next
STABLE_DAMPING = 0.15
STABLE_PARTICIPATION = 0.95  # least correlation of the participation vectors
LARGEST_RATIO = 0.4
FIRST_ORDER = 4  # lower orders leave no poles for the band's other modes
LAST_ORDER = 6  # beyond it a stable pole of a broad peak is part of a split one
# A pole with less than this times the damping of the chosen one is a second mode; one with more is
# a smooth background.
RIVAL_RATIO = 3.0
# Of the poles of a whole band.
HIGHEST_ORDER = 40
CLUSTER_HZ = 0.012  # relative width in frequency of one pole's column
FEWEST_ORDERS = 6  # orders in which a pole must be stable
LARGEST_MODE_RATIO = 0.15  # a pole with more damping is background


@dataclass(frozen=True)
class StabilisationChart:
    """Poles of all orders, each compared with the nearest one of the order before.

    order: (pole,).
    pole: (pole,) rad/s.
    stable_frequency, stable_damping, stable_participation: (pole,) bool.
    """

    order: np.ndarray
    pole: np.ndarray
    stable_frequency: np.ndarray
    stable_damping: np.ndarray
    stable_participation: np.ndarray

    @property
    def stable(self) -> np.ndarray:
        """Return (pole,) bool: stable in all three."""
        return self.stable_frequency & self.stable_damping & self.stable_participation


def stabilisation_chart(
    equations: NormalEquations, decay: float, orders: Iterable[int]
) -> StabilisationChart:
    """Return the StabilisationChart for ascending orders.

    decay: 1/s of the exponential window, subtracted.
    """
    rows, before = [], None
    for order in orders:
        poles, participation = equations.poles(order)
        poles = poles + decay
        flags = _stable_flags(poles, participation, before)
        rows.append((np.full(poles.size, order), poles, *flags))
        before = (poles, participation)
    return StabilisationChart(*map(np.concatenate, zip(*rows, strict=True)))


def _stable_flags(
    poles: np.ndarray, participation: np.ndarray, before: tuple[np.ndarray, np.ndarray] | None
) -> Sequence[np.ndarray]:
    """Return three arrays (pole,) bool: stable in frequency, damping and participation."""
    if before is None or before[0].size == 0:
        return [np.zeros(poles.size, dtype=bool)] * 3
    nearest = np.argmin(np.abs(poles[:, None] - before[0]), axis=1)
    frequency, ratio = frequency_of(poles)
    old_frequency, old_ratio = frequency_of(before[0][nearest])
    other = before[1][nearest]
    likeness = np.abs(np.sum(participation.conj() * other, axis=1)) ** 2
    likeness /= np.sum(np.abs(participation) ** 2, axis=1) * np.sum(np.abs(other) ** 2, axis=1)
    return (
        np.abs(frequency - old_frequency) < STABLE_FREQUENCY * frequency,
        np.abs(ratio - old_ratio) < STABLE_DAMPING * np.abs(ratio),
        likeness > STABLE_PARTICIPATION,
    )


def nearest_pole(poles: np.ndarray, start: complex, radius_Hz: float) -> int | None:
    """Return the index of the plausible pole nearest to `start` (rad/s), or None.

    radius_Hz: largest difference in frequency.
    """
    frequency, ratio = frequency_of(poles)
    near = np.flatnonzero(
        (np.abs(frequency - np.abs(start) / (2.0 * np.pi)) < radius_Hz)
        & (ratio > 0.0)
        & (ratio < LARGEST_RATIO)
    )
    return None if near.size == 0 else int(near[np.argmin(np.abs(poles[near] - start))])


def first_stable_order(
    chart: StabilisationChart, start: complex, radius_Hz: float
) -> tuple[int, bool]:
    """Return (order, whether the pole is stable there) for the main peak.

    It is the lowest order from FIRST_ORDER to LAST_ORDER that shows the main peak as one stable
    pole. Higher orders add only noise to the peak of one mode, and split the peak of a nonlinear
    structure, whose stiffness varies, into several poles. An order with a second pole as near is
    passed over. If no order qualifies, it is the highest one up to FIRST_ORDER with a single
    pole, marked as not stable.

    start: a guess of the pole in rad/s.
    radius_Hz: how far from it the pole may be.
    """
    last, single = start, []
    for order in (int(order) for order in np.unique(chart.order) if order <= LAST_ORDER):
        here = np.flatnonzero(chart.order == order)
        chosen = nearest_pole(chart.pole[here], last, radius_Hz)
        if chosen is None:
            continue
        last = chart.pole[here[chosen]]
        frequency, ratio = frequency_of(chart.pole[here])
        rivals = (
            (np.abs(frequency - frequency[chosen]) < radius_Hz)
            & (ratio > 0.0)
            & (ratio < RIVAL_RATIO * ratio[chosen])
        )
        if rivals.sum() > 1:
            continue
        if order >= FIRST_ORDER and chart.stable[here[chosen]]:
            return order, True
        single.append(order)
    return max((order for order in single if order <= FIRST_ORDER), default=FIRST_ORDER), False


def stable_poles(
    frequency: np.ndarray, response: np.ndarray
) -> tuple[np.ndarray, np.ndarray, StabilisationChart]:
    """Return (frequency (pole,) Hz ascending, damping ratio (pole,), chart) of a band.

    They are medians over the orders in which each pole is stable.

    frequency: (line,) Hz.
    response: (output, line) complex, of one force; lines may be weighted by their noise.
    """
    equations = NormalEquations(frequency, response[:, None, :], HIGHEST_ORDER)
    chart = stabilisation_chart(equations, 0.0, range(2, HIGHEST_ORDER + 1))
    place, ratio = frequency_of(chart.pole)
    usable = (
        chart.stable
        & (ratio > 0.0)
        & (ratio < LARGEST_MODE_RATIO)
        & (place > frequency[0])
        & (place < frequency[-1])
    )
    place, ratio, order = place[usable], ratio[usable], chart.order[usable]
    found = []
    while place.size:
        spread = np.abs(place[:, None] - place) < CLUSTER_HZ * place
        near = spread[np.argmax(spread.sum(axis=1))]
        if np.unique(order[near]).size < FEWEST_ORDERS:
            break
        found.append((float(np.median(place[near])), float(np.median(ratio[near]))))
        place, ratio, order = place[~near], ratio[~near], order[~near]
    medians = np.array(sorted(found)).reshape(-1, 2)
    return medians[:, 0], medians[:, 1], chart
