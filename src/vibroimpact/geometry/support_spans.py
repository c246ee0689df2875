"""Which stretches of a tube a support takes, and the places of its contact points on them."""

from typing import Any

import numpy as np

from .centreline import Centreline

# An edge of a support this close to an end of the tube or to a joint of segments lies on it: the
# short element between them would have a stiffness of round-off.
SNAP_M = 1.0e-4


def support_middles(centreline: Centreline, support: Any) -> list[float]:
    """Return the arc lengths in m of the middles of a support's plate or pairs of bars.

    support: entry of the configuration.

    Raises ValueError when one is off the tube.
    """
    middle = _snapped(centreline, centreline.locate(support.at_m, f"support {support.name}"))
    spacing = getattr(getattr(support, "profile", None), "spacing_m", 0.0)
    if spacing == 0.0:
        return [middle]
    places = [middle - 0.5 * spacing, middle + 0.5 * spacing]
    if min(places) < 0.0 or max(places) > centreline.length:
        raise ValueError(
            f"support {support.name}: its bars at arc lengths {places[0]:.4f} and {places[1]:.4f} m"
            f" are not both on the tube (0 to {centreline.length:.4f} m): move it or lower"
            " profile.spacing_m"
        )
    return places


def support_spans(centreline: Centreline, support: Any) -> list[tuple[float, float]]:
    """Return [(first, last)] arc lengths in m of the plates or bars of a support, in its order.

    There is one, about at_m and height_m long; the two pairs of bars of a lattice with spacing_m
    have one each. A part that reaches past an end of the tube is cut there.

    support: entry of the configuration.

    Raises ValueError when at_m, or the middle of a pair of bars, is off the tube.
    """
    half, spans = 0.5 * support.height_m, []
    for middle in support_middles(centreline, support):
        low, high = max(middle - half, 0.0), min(middle + half, centreline.length)
        spans.append((_snapped(centreline, low), _snapped(centreline, high)))
    return spans


def contact_places(centreline: Centreline, support: Any) -> np.ndarray:
    """Return (contact_point,) arc lengths in m of a support's contact points, in its order.

    They are evenly spaced over each plate or pair of bars, both edges included. A single point is
    at the middle, if an end of the tube cuts nothing off.

    support: entry of the configuration.
    """
    if support.points == 1:
        return np.array(support_middles(centreline, support))
    spans = support_spans(centreline, support)
    return np.concatenate([np.linspace(*span, support.points) for span in spans])


def _snapped(centreline: Centreline, place: float) -> float:
    """Return an arc length in m, or the end or joint of segments that is within SNAP_M of it."""
    joints = (0.0, *(segment.end for segment in centreline.segments))
    near = min(joints, key=lambda joint: abs(joint - place))
    return near if abs(near - place) < SNAP_M else place
