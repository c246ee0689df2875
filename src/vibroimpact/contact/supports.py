"""The contact points of the supports: places, directions and shares of the support's stiffness."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import SAME_PLACE_M, Centreline
from vibroimpact.geometry.directions import transverse_directions

from .laws import ContactLaws


@dataclass(frozen=True, eq=False)
class ContactPoints:
    """All contact points of all supports, in the order of the supports and along the tube.

    arc_length: (contact_point,) m.
    position: (contact_point, 3) m.
    directions: (contact_point, 2, 3), unit vectors of the two directions in which contact acts.
    weight: (contact_point,), share of the support's stiffness; sums to 1 per support.
    support: (contact_point,) int, number of the support.
    stiffness: (contact_point,) N/m.
    gap_factor: (contact_point,), times the case's gap.
    centre_offset: (contact_point, 2) m along the two directions.
    """

    arc_length: np.ndarray
    position: np.ndarray
    directions: np.ndarray
    weight: np.ndarray
    support: np.ndarray
    stiffness: np.ndarray
    gap_factor: np.ndarray
    centre_offset: np.ndarray


def contact_arc_lengths(centreline: Centreline, support: ConfigPart) -> np.ndarray:
    """Return (contact_point,) arc lengths in m of a support's contact points.

    They are evenly spaced over the height of the support, both edges included; a single point is at
    mid-height. Raises ValueError when the support is off the tube or reaches past one of its ends.
    """
    middle = centreline.locate(support.at_m, f"support {support.name}")
    if support.points == 1:
        return np.array([middle])
    half = 0.5 * support.height_m
    if middle - half < SAME_PLACE_M or middle + half > centreline.length - SAME_PLACE_M:
        raise ValueError(
            f"support {support.name} reaches from arc length {middle - half:.4f} to"
            f" {middle + half:.4f} m, past an end of the tube (0 to {centreline.length:.4f} m):"
            " move it or lower its height_m"
        )
    return np.linspace(middle - half, middle + half, support.points)


def place_contact_points(centreline: Centreline, supports: Sequence[ConfigPart]) -> ContactPoints:
    """Return the ContactPoints of supports on a tube.

    supports: entries of the configuration.

    Raises ValueError when a list has another length than the support's number of points, or when
    supports overlap; the message names the support.
    """
    if not supports:
        return contacts_at_points(supports)
    places = [contact_arc_lengths(centreline, support) for support in supports]
    _require_apart(supports, places)
    stiffness = [_per_point(support, "stiffness_N_per_m", share=True) for support in supports]
    arc_length = np.concatenate(places)
    return ContactPoints(
        arc_length=arc_length,
        position=np.array([centreline.position(place) for place in arc_length]),
        directions=np.array(
            [transverse_directions(centreline.direction(place)) for place in arc_length]
        ),
        weight=np.concatenate([values / values.sum() for values in stiffness]),
        support=np.repeat(np.arange(len(supports)), [len(points) for points in places]),
        stiffness=np.concatenate(stiffness),
        gap_factor=np.concatenate([_per_point(support, "gap_factor") for support in supports]),
        centre_offset=np.concatenate([_offsets(support) for support in supports]),
    )


def contacts_at_points(supports: Sequence[ConfigPart]) -> ContactPoints:
    """Return the ContactPoints of supports at named points of a structure that is no tube.

    Each support is one contact point that acts along x and y. Positions are zero.
    """
    stiffness = np.array([np.ravel(support.stiffness_N_per_m)[0] for support in supports])
    return ContactPoints(
        arc_length=np.full(len(supports), np.nan),
        position=np.zeros((len(supports), 3)),
        directions=np.tile(np.eye(3)[:2], (len(supports), 1, 1)),
        weight=np.ones(len(supports)),
        support=np.arange(len(supports)),
        stiffness=stiffness,
        gap_factor=np.array([np.ravel(support.gap_factor)[0] for support in supports]),
        centre_offset=np.array(
            [np.reshape(support.centre_offset_m, (-1, 2))[0] for support in supports]
        ).reshape(-1, 2),
    )


def contact_laws(supports: Sequence[ConfigPart], contact: ContactPoints) -> ContactLaws:
    """Return the ContactLaws of the contact points of supports.

    supports: entries of the configuration; totals of a support are shared by its points.
    contact: their contact points.
    """
    columns = {
        column: np.array(
            [
                value(supports[number], contact.weight[point])
                for point, number in enumerate(contact.support)
            ],
            dtype=float,
        )
        for column, value in LAW_COLUMNS.items()
    }
    columns["stick_stiffness"] = contact.stiffness * [
        supports[number].stick_stiffness_ratio for number in contact.support
    ]
    lands = [
        (point, np.deg2rad(angle))
        for point, number in enumerate(contact.support)
        if supports[number].profile.kind == "planes"
        for angle in supports[number].profile.normals_deg
    ]
    angles = np.array([angle for _, angle in lands])
    return ContactLaws(
        **{name: np.reshape(values, len(contact.support)) for name, values in columns.items()},
        land_point=np.array([point for point, _ in lands], dtype=int),
        # Rounded to exact zeros across a plane, so that the planes of motion stay uncoupled.
        land_normal=np.round(np.column_stack([np.cos(angles), np.sin(angles)]), 15),
    )


def _lobes(key, factor=1.0):
    return lambda support, share: (
        factor * getattr(support.profile, key) if support.profile.kind == "lobes" else 0.0
    )


# column of ContactLaws -> its value from (support, share of the support that the point carries)
LAW_COLUMNS = {
    "gap": lambda support, share: np.nan if support.gap_m is None else support.gap_m,
    "damping": lambda support, share: support.damping_N_s_per_m * share,
    "hunt_crossley": lambda support, share: support.hunt_crossley_s_per_m,
    "hertz": lambda support, share: support.hertz_N_per_m15 * share,
    "friction": lambda support, share: support.friction,
    "lobes": _lobes("count"),
    "lobe_depth": _lobes("depth_m"),
    "lobe_angle": _lobes("angle_deg", np.pi / 180.0),
}


def _per_point(support: ConfigPart, key: str, share: bool = False) -> np.ndarray:
    """Return (contact_point,) values of a key that is a list or a number.

    share: divide a number by the number of points.
    """
    given = np.asarray(getattr(support, key), dtype=float)
    if given.ndim == 0:
        return np.full(support.points, given / support.points if share else given)
    _require_length(support, key, given)
    return given


def _offsets(support: ConfigPart) -> np.ndarray:
    """Return (contact_point, 2) centre offsets in m along the two transverse directions."""
    given = np.asarray(support.centre_offset_m, dtype=float)
    if given.ndim == 1:
        return np.tile(given, (support.points, 1))
    _require_length(support, "centre_offset_m", given)
    return given


def _require_length(support: ConfigPart, key: str, given: np.ndarray) -> None:
    """Raise ValueError unless there is one entry per contact point of a support."""
    if len(given) != support.points:
        raise ValueError(
            f"support {support.name}: {key} has {len(given)} values for {support.points} points:"
            " give one per point"
        )


def _require_apart(supports: Sequence[ConfigPart], places: list[np.ndarray]) -> None:
    """Raise ValueError when two supports share a stretch of the tube."""
    order = sorted(range(len(places)), key=lambda number: places[number][0])
    for lower, upper in zip(order[:-1], order[1:], strict=True):
        if places[lower][-1] > places[upper][0] - SAME_PLACE_M:
            raise ValueError(
                f"supports {supports[lower].name} and {supports[upper].name} overlap on the tube:"
                " move one of them"
            )
