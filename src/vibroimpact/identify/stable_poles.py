"""The poles of a band from measured frequency responses: those stable over many orders."""

import numpy as np

from vibroimpact.identify.linear.poles import frequency_of

from .lscf import NormalEquations
from .stabilisation import StabilisationChart, stabilisation_chart

HIGHEST_ORDER = 40
CLUSTER_HZ = 0.012  # relative width in frequency of one pole's column
FEWEST_ORDERS = 6  # orders in which a pole must be stable
LARGEST_RATIO = 0.15  # a pole with more damping is background


def stable_poles(
    frequency: np.ndarray, response: np.ndarray, highest_order: int = HIGHEST_ORDER
) -> tuple[np.ndarray, np.ndarray, StabilisationChart]:
    """Return (frequency (pole,) Hz ascending, damping ratio (pole,), chart).

    They are medians over the orders in which each pole is stable.

    frequency: (line,) Hz.
    response: (output, line) complex, of one force; lines may be weighted by their noise.
    """
    equations = NormalEquations(frequency, response[:, None, :], highest_order)
    chart = stabilisation_chart(equations, 0.0, range(2, highest_order + 1))
    place, ratio = frequency_of(chart.pole)
    usable = (
        chart.stable
        & (ratio > 0.0)
        & (ratio < LARGEST_RATIO)
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
