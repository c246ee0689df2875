"""The poles of a band from measured frequency responses: those of the stabilisation chart that stay
put over many orders.
"""

import numpy as np

from .lscf import NormalEquations
from .stabilisation import stabilisation_chart
from .update import frequency_of

HIGHEST_ORDER = 40
CLUSTER_HZ = 0.012  # relative width in frequency of one pole's column
FEWEST_ORDERS = 6  # orders in which a pole must be stable
LARGEST_RATIO = 0.15  # a pole with more damping is background


def stable_poles(frequency, response, highest_order=HIGHEST_ORDER):
    """Return (frequency (pole,) Hz ascending, damping_ratio (pole,), chart): medians over the
    orders in which each pole is stable.

    frequency (line,) Hz; response (output, line) complex, of one force; the noise of a line may
    have been weighted in.
    """
    chart = stabilisation_chart(
        NormalEquations(frequency, response[:, None, :], highest_order),
        0.0,
        range(2, highest_order + 1),
    )
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
    found = np.array(sorted(found)).reshape(-1, 2)
    return found[:, 0], found[:, 1], chart
