"""The contact points of the supports: where they are, in which directions they act and what share of their support each carries."""

from dataclasses import dataclass

import numpy as np

from vibroimpact.centreline import SAME_PLACE_M, transverse_directions


@dataclass(frozen=True, eq=False)
class ContactPoints:
    """All contact points of all supports, in the order of the supports and along the tube; see `ModalModel` for the fields.

    arc_length (contact_point,) m; position (contact_point, 3) m; directions (contact_point, 2, 3); weight (contact_point,);
    support (contact_point,) int; stiffness (contact_point,) N/m; gap_factor (contact_point,); centre_offset (contact_point, 2) m.
    """

    arc_length: np.ndarray
    position: np.ndarray
    directions: np.ndarray
    weight: np.ndarray
    support: np.ndarray
    stiffness: np.ndarray
    gap_factor: np.ndarray
    centre_offset: np.ndarray


def contact_arc_lengths(centreline, support):
    """Return (contact_point,) arc lengths in m: evenly spaced over the height, both edges included; a single point at mid-height.

    Raises ValueError when the support is off the tube or reaches past one of its ends.
    """
    middle = centreline.locate(support.at_m, f"support {support.name}")
    if support.points == 1:
        return np.array([middle])
    half = 0.5 * support.height_m
    if middle - half < SAME_PLACE_M or middle + half > centreline.length - SAME_PLACE_M:
        raise ValueError(f"support {support.name} reaches from arc length {middle - half:.4f} to {middle + half:.4f} m, past an end of "
                         f"the tube (0 to {centreline.length:.4f} m): move it or lower its height_m")
    return np.linspace(middle - half, middle + half, support.points)


def place_contact_points(centreline, supports):
    """Return the ContactPoints of `supports` (config entries) on the centreline.

    Raises ValueError when a list has another length than `points`, or supports overlap; the message names the support.
    """
    places = [contact_arc_lengths(centreline, support) for support in supports]
    _require_apart(supports, places)
    stiffness = [_per_point(support, "stiffness_N_per_m", share=True) for support in supports]
    arc_length = np.concatenate(places) if places else np.zeros(0)
    directions = [transverse_directions(centreline.direction(place)) for place in arc_length]
    return ContactPoints(
        arc_length=arc_length,
        position=np.array([centreline.position(place) for place in arc_length]).reshape(-1, 3),
        directions=np.array(directions).reshape(-1, 2, 3),
        weight=np.concatenate([values / values.sum() for values in stiffness]) if stiffness else np.zeros(0),
        support=np.repeat(np.arange(len(supports)), [len(points) for points in places]),
        stiffness=np.concatenate(stiffness) if stiffness else np.zeros(0),
        gap_factor=np.concatenate([_per_point(support, "gap_factor") for support in supports]) if stiffness else np.zeros(0),
        centre_offset=np.concatenate([_offsets(support) for support in supports]) if stiffness else np.zeros((0, 2)),
    )


def _per_point(support, key, share=False):
    """Return (contact_point,) values of `key`: a list as it is, a number repeated (or divided by the points where `share`)."""
    given = np.asarray(getattr(support, key), dtype=float)
    if given.ndim == 0:
        return np.full(support.points, given / support.points if share else given)
    _require_length(support, key, given)
    return given


def _offsets(support):
    """Return (contact_point, 2) centre offsets in m along the two transverse directions."""
    given = np.asarray(support.centre_offset_m, dtype=float)
    if given.ndim == 1:
        return np.tile(given, (support.points, 1))
    _require_length(support, "centre_offset_m", given)
    return given


def _require_length(support, key, given):
    """Raise ValueError unless `given` has one entry per contact point of `support`."""
    if len(given) != support.points:
        raise ValueError(f"support {support.name}: {key} has {len(given)} values for {support.points} points: give one per point")


def _require_apart(supports, places):
    """Raise ValueError when two supports share a stretch of the tube."""
    order = sorted(range(len(places)), key=lambda number: places[number][0])
    for lower, upper in zip(order[:-1], order[1:], strict=True):
        if places[lower][-1] > places[upper][0] - SAME_PLACE_M:
            raise ValueError(f"supports {supports[lower].name} and {supports[upper].name} overlap on the tube: move one of them")
