"""Stabilisation chart: which poles stay put while the order of the estimator grows, and the choice
of the main peak's pole.
"""

from dataclasses import dataclass

import numpy as np

from .update import frequency_of

STABLE_FREQUENCY = 0.01  # largest relative change from one order to the next
STABLE_DAMPING = 0.15
STABLE_PARTICIPATION = 0.95  # least correlation of the participation vectors
LARGEST_RATIO = 0.4
FIRST_ORDER = 4  # the orders below leave no room for the band's other modes
LAST_ORDER = 6  # beyond it a stable pole is, on broad peaks, a stable part of a split one
# a pole with less than this times the damping of the chosen one is a second mode, not a smooth
# background
RIVAL_RATIO = 3.0


@dataclass(frozen=True)
class StabilisationChart:
    """Poles (pole,) of all orders, in rad/s, with order (pole,), and whether each is stable in
    frequency, damping and participation.

    A pole is compared with the nearest one of the order before.
    """

    order: np.ndarray
    pole: np.ndarray
    stable_frequency: np.ndarray
    stable_damping: np.ndarray
    stable_participation: np.ndarray

    @property
    def stable(self):
        """Return (pole,) bool: stable in all three."""
        return self.stable_frequency & self.stable_damping & self.stable_participation


def stabilisation_chart(equations, decay, orders):
    """Return the StabilisationChart of NormalEquations for ascending orders; decay (1/s) of the
    exponential window is taken off.
    """
    columns = [[], [], [], [], []]
    before = None
    for order in orders:
        poles, participation = equations.poles(order)
        poles = poles + decay
        flags = _stable_flags(poles, participation, before)
        for column, values in zip(
            columns, (np.full(poles.size, order), poles, *flags), strict=True
        ):
            column.append(values)
        before = (poles, participation)
    return StabilisationChart(*(np.concatenate(column) for column in columns))


def _stable_flags(poles, participation, before):
    """Return three arrays (pole,) bool: stable against the nearest pole of the order before in
    frequency, damping, participation.
    """
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


def nearest_pole(poles, start, reach_Hz):
    """Return the index of the pole nearest to `start` (rad/s) among the plausible ones within
    reach_Hz of its frequency, or None.
    """
    frequency, ratio = frequency_of(poles)
    near = np.flatnonzero(
        (np.abs(frequency - np.abs(start) / (2.0 * np.pi)) < reach_Hz)
        & (ratio > 0.0)
        & (ratio < LARGEST_RATIO)
    )
    return None if near.size == 0 else int(near[np.argmin(np.abs(poles[near] - start))])


def first_stable_order(chart, start, reach_Hz):
    """Return (order, whether the pole is stable there): the lowest order from FIRST_ORDER to
    LAST_ORDER that shows the main peak as one stable pole.

    start: a guess of the pole (rad/s); reach_Hz: how far from it the pole may be. Higher orders add
    nothing to a peak of one mode but noise, and split the peak of a nonlinear structure, whose
    stiffness varies, into several poles: an order where a second pole lies as near is passed over.
    Where no order will do, the highest one up to FIRST_ORDER with a single pole is taken, and said
    not to be stable.
    """
    last, single = start, []
    for order in (int(order) for order in np.unique(chart.order) if order <= LAST_ORDER):
        here = np.flatnonzero(chart.order == order)
        chosen = nearest_pole(chart.pole[here], last, reach_Hz)
        if chosen is None:
            continue
        last = chart.pole[here[chosen]]
        frequency, ratio = frequency_of(chart.pole[here])
        rivals = (
            (np.abs(frequency - frequency[chosen]) < reach_Hz)
            & (ratio > 0.0)
            & (ratio < RIVAL_RATIO * ratio[chosen])
        )
        if rivals.sum() > 1:
            continue
        if order >= FIRST_ORDER and chart.stable[here[chosen]]:
            return order, True
        single.append(order)
    return max((order for order in single if order <= FIRST_ORDER), default=FIRST_ORDER), False


def stable_column(chart, start, reach_Hz):
    """Return the poles (order,) in rad/s of the longest run of orders in which the pole near
    `start` is stable, an empty array if none.

    For frequency responses of a structure without a model: there is little noise, and the order
    must grow until every mode of the band has found its pole. start: a guess (rad/s); reach_Hz: how
    far from it the pole may be.
    """
    longest, run, last = [], [], start
    for order in np.unique(chart.order):
        here = np.flatnonzero((chart.order == order) & chart.stable)
        chosen = nearest_pole(chart.pole[here], last, reach_Hz)
        if chosen is None:
            run = []
            continue
        last = chart.pole[here[chosen]]
        run = [*run, last]
        longest = run if len(run) > len(longest) else longest
    return np.array(longest)
