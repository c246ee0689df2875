"""The contact points of the supports: places, directions and shares of the support's stiffness."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import SAME_PLACE_M, Centreline
from vibroimpact.geometry.directions import carried_directions, transverse_directions
from vibroimpact.geometry.support_spans import contact_places

from .laws import ContactLaws
from .profiles import land_extra_gaps, land_normals, lobes


@dataclass(frozen=True, eq=False)
class ContactPoints:
    """All contact points of all supports, in the order of the supports and along the tube.

    arc_length: (contact_point,) m.
    position: (contact_point, 3) m.
    directions: (contact_point, 2, 3), unit vectors of the two directions in which contact acts.
    weight: (contact_point,), share of the support's stiffness; sums to 1 per support.
    support: (contact_point,) int, number of the support.
    pair: (contact_point,) int, number of the pair of bars within its support: 1 for the second pair
        of a lattice at a height of its own, else 0.
    stiffness: (contact_point,) N/m.
    gap_factor: (contact_point,), times the case's gap.
    centre_offset: (contact_point, 2) m along the two directions.
    """

    arc_length: np.ndarray
    position: np.ndarray
    directions: np.ndarray
    weight: np.ndarray
    support: np.ndarray
    pair: np.ndarray
    stiffness: np.ndarray
    gap_factor: np.ndarray
    centre_offset: np.ndarray


def place_contact_points(centreline: Centreline, supports: Sequence[ConfigPart]) -> ContactPoints:
    """Return the ContactPoints of supports on a tube.

    supports: entries of the configuration.

    Raises ValueError when a list has another length than the support's number of points, or when
    supports overlap; the message names the support.
    """
    if not supports:
        return contacts_at_points(supports)
    places = [contact_places(centreline, support) for support in supports]
    order = sorted(range(len(places)), key=lambda number: places[number][0])
    for lower, upper in zip(order[:-1], order[1:], strict=True):
        if places[lower][-1] > places[upper][0] + SAME_PLACE_M:  # they may meet
            raise ValueError(
                f"supports {supports[lower].name} and {supports[upper].name} overlap on the tube:"
                " move one of them"
            )
    parts = [
        _points_of(centreline, support, number, at)
        for number, (support, at) in enumerate(zip(supports, places, strict=True))
    ]
    columns = [field.name for field in fields(ContactPoints)]
    return ContactPoints(
        *(np.concatenate([getattr(part, name) for part in parts]) for name in columns)
    )


def _points_of(
    centreline: Centreline, support: ConfigPart, number: int, places: np.ndarray
) -> ContactPoints:
    """Return the ContactPoints of the support with a number, at arc lengths in m."""
    pairs = len(places) // support.points  # a lattice has its points once per pair of bars
    stiffness = _per_point(support, "stiffness_N_per_m")
    if np.ndim(support.stiffness_N_per_m) == 0:  # the total of the support
        stiffness = stiffness / support.points
    stiffness = np.tile(stiffness, pairs)
    return ContactPoints(
        arc_length=places,
        position=np.array([centreline.position(place) for place in places]),
        directions=_directions(centreline, support, places),
        weight=stiffness / stiffness.sum(),
        support=np.full(len(places), number),
        pair=np.repeat(np.arange(pairs), support.points),
        stiffness=stiffness,
        gap_factor=np.tile(_per_point(support, "gap_factor"), pairs),
        centre_offset=np.tile(_per_point(support, "centre_offset_m", 1), (pairs, 1)),
    )


def contacts_at_points(
    supports: Sequence[ConfigPart], points: Mapping[str, Sequence[float]] | None = None
) -> ContactPoints:
    """Return the ContactPoints of supports at named points of a structure other than a tube.

    Each support is one contact point that acts along x and y. points: {name: (3,)} m. Positions are
    zero unless the place of every support is among them.
    """
    points = points or {}
    known = all(support.point in points for support in supports)
    stiffness = np.array([np.ravel(support.stiffness_N_per_m)[0] for support in supports])
    return ContactPoints(
        arc_length=np.full(len(supports), np.nan),
        position=np.array(
            [points[support.point] if known else np.zeros(3) for support in supports]
        ).reshape(-1, 3),
        directions=np.tile(np.eye(3)[:2], (len(supports), 1, 1)),
        weight=np.ones(len(supports)),
        support=np.arange(len(supports)),
        pair=np.zeros(len(supports), int),
        stiffness=stiffness,
        gap_factor=np.array([np.ravel(support.gap_factor)[0] for support in supports]),
        centre_offset=np.array(
            [np.reshape(support.centre_offset_m, (-1, 2))[0] for support in supports]
        ).reshape(-1, 2),
    )


def contact_laws(supports: Sequence[ConfigPart], contact: ContactPoints) -> ContactLaws:
    """Return the ContactLaws of the contact points of supports.

    supports: entries of the configuration; totals of a support are shared by its points, in a
        lattice by those of each pair of bars.
    contact: their contact points.
    """
    share = contact.weight * _pairs_of_bars(contact)[contact.support]
    own = [supports[number] for number in contact.support]
    columns = {
        "gap": np.array([_gap(support) for support in own], dtype=float),
        "damping": share * [support.damping_N_s_per_m for support in own],
        "hunt_crossley": np.array([support.hunt_crossley_s_per_m for support in own], dtype=float),
        "hertz": share * [support.hertz_N_per_m15 for support in own],
        "friction": np.array([support.friction for support in own], dtype=float),
        "stick_stiffness": contact.stiffness * [support.stick_stiffness_ratio for support in own],
    }
    shapes = [
        (support.profile, contact.directions[point], int(contact.pair[point]))
        for point, support in enumerate(own)
    ]
    rounded = np.array([lobes(profile, directions) for profile, directions, _ in shapes])
    columns |= zip(("lobes", "lobe_depth", "lobe_angle"), rounded.reshape(-1, 3).T, strict=True)
    lands = [land_normals(*shape) for shape in shapes]
    extra = [
        land_extra_gaps(each.profile, len(land)) for each, land in zip(own, lands, strict=True)
    ]
    return ContactLaws(
        **{name: np.reshape(values, len(contact.support)) for name, values in columns.items()},
        land_point=np.repeat(np.arange(len(lands)), [len(normals) for normals in lands]),
        land_normal=np.concatenate([np.zeros((0, 2)), *lands]),
        land_extra_gap=np.concatenate([np.zeros(0), *extra]),
    )


def contact_preload(supports: Sequence[ConfigPart], contact: ContactPoints) -> np.ndarray:
    """Return (contact_point,) N, the force at rest of each flat land of the contact points.

    supports, contact: as in contact_laws.
    """
    share = contact.weight * _pairs_of_bars(contact)[contact.support]
    totals = [supports[number].preload_N or 0.0 for number in contact.support]
    return np.array(totals).reshape(-1) * share


def _gap(support: ConfigPart) -> float:
    """Return the gap in m of a support: minus the indentation by its preload, NaN for the gap of
    the case.
    """
    if support.preload_N is None:
        return np.nan if support.gap_m is None else support.gap_m
    if support.hertz_N_per_m15 > 0.0:
        return -float((support.preload_N / support.hertz_N_per_m15) ** (2.0 / 3.0))
    return -support.preload_N / float(np.sum(support.stiffness_N_per_m))


def _pairs_of_bars(contact: ContactPoints) -> np.ndarray:
    """Return (support,) numbers of pairs of bars: 2 for a lattice with spacing_m, else 1."""
    pairs = np.ones(int(contact.support.max(initial=-1)) + 1, dtype=int)
    np.maximum.at(pairs, contact.support, contact.pair + 1)
    return pairs


def _directions(centreline: Centreline, support: ConfigPart, places: np.ndarray) -> np.ndarray:
    """Return (contact_point, 2, 3), the transverse directions at arc lengths (contact_point,) in m.

    They are those at the middle of the support, turned with the tube: the two global axes that are
    least aligned with a tube may be others at its edges.
    """
    middle = centreline.direction(centreline.locate(support.at_m, f"support {support.name}"))
    directions = transverse_directions(middle)

    def turned(tangent: np.ndarray) -> np.ndarray:
        same = np.array_equal(tangent, middle)
        return directions if same else carried_directions(directions, tangent)

    return np.array([turned(centreline.direction(place)) for place in places])


def _per_point(support: ConfigPart, key: str, axes: int = 0) -> np.ndarray:
    """Return (contact_point, ...) values of a key that is a list, or one value for all points.

    axes: of one value. Raises ValueError for a list of another length.
    """
    given = np.asarray(getattr(support, key), dtype=float)
    if given.ndim == axes:
        return np.repeat(given[None], support.points, axis=0)
    if len(given) != support.points:
        raise ValueError(
            f"support {support.name}: {key} has {len(given)} values for {support.points} points:"
            " give one per point"
        )
    return given
