"""The centreline of a tube: straight and bend segments along an arc length."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .directions import unit_vector

LOCATION_TOLERANCE_M = 5.0e-3
SAME_PLACE_M = 1.0e-9

Piece = tuple[float, float, tuple[float, ...] | None]  # length in m, radius in m, toward


@dataclass(frozen=True)
class Segment:
    """A straight or circular segment.

    begin: arc length of its start, m.
    length: its length in m.
    start (3,): position in m of its beginning.
    tangent (3,): unit tangent at its beginning.
    radius: in m, infinite for a straight segment.
    toward (3,): unit vector from the beginning to the centre of a bend, None for a straight
    segment.
    """

    begin: float
    length: float
    start: np.ndarray
    tangent: np.ndarray
    radius: float = np.inf
    toward: np.ndarray | None = None

    @property
    def end(self) -> float:
        """Return the arc length of the end in m."""
        return self.begin + self.length

    def position(self, arc_length: float) -> np.ndarray:
        """Return the position (3,) in m at an arc length in m."""
        along = arc_length - self.begin
        if self.toward is None:
            return self.start + along * self.tangent
        angle = along / self.radius
        return self.start + self.radius * (
            np.sin(angle) * self.tangent + (1.0 - np.cos(angle)) * self.toward
        )

    def direction(self, arc_length: float) -> np.ndarray:
        """Return the unit tangent (3,) at an arc length in m."""
        if self.toward is None:
            return self.tangent
        angle = (arc_length - self.begin) / self.radius
        return unit_vector(np.cos(angle) * self.tangent + np.sin(angle) * self.toward)

    def nearest(self, position: np.ndarray) -> float:
        """Return the arc length in m of the point nearest to `position` (3,) in m."""
        offset = position - self.start
        if self.toward is None:
            return self.begin + float(np.clip(offset @ self.tangent, 0.0, self.length))
        angle = np.arctan2(offset @ self.tangent, self.radius - offset @ self.toward) % (
            2.0 * np.pi
        )
        inside = [self.begin + angle * self.radius] if angle * self.radius <= self.length else []
        return min(
            [*inside, self.begin, self.end],
            key=lambda place: np.linalg.norm(self.position(place) - position),
        )


@dataclass(frozen=True)
class Centreline:
    """Segments joined end to end with a continuous tangent. Positions along it are arc lengths in m
    from the start.
    """

    segments: tuple[Segment, ...]
    known: dict = field(default_factory=dict, repr=False, compare=False)  # nearest points so far

    @property
    def length(self) -> float:
        """Return the total arc length in m."""
        return self.segments[-1].end

    def segment_at(self, arc_length: float) -> Segment:
        """Return the Segment at an arc length in m; at a joint, the earlier one."""
        return next(
            (piece for piece in self.segments if arc_length <= piece.end + SAME_PLACE_M),
            self.segments[-1],
        )

    def position(self, arc_length: float) -> np.ndarray:
        """Return the position (3,) in m at an arc length in m."""
        return self.segment_at(arc_length).position(arc_length)

    def direction(self, arc_length: float) -> np.ndarray:
        """Return the unit tangent (3,) at an arc length in m."""
        return self.segment_at(arc_length).direction(arc_length)

    def nearest(self, position: Sequence[float] | np.ndarray) -> list[tuple[float, float]]:
        """Return (arc length in m, distance in m) of the point of each segment that is nearest to
        `position` (3,) in m.
        """
        key = tuple(map(float, position))
        if key not in self.known:
            given = np.array(key)
            places = [piece.nearest(given) for piece in self.segments]
            self.known[key] = [
                (place, float(np.linalg.norm(self.position(place) - given))) for place in places
            ]
        return self.known[key]

    def locate(self, position: ArrayLike, name: str) -> float:
        """Return the arc length in m of the point nearest to `position` (3,) in m.

        name: the owner of the position, for the message.
        Raises ValueError when the position is more than 5 mm off the centreline. The message gives
        the distance and the nearest point.
        """
        position = np.asarray(position, dtype=float)
        place, distance = min(self.nearest(position), key=lambda each: each[1])
        if not distance <= LOCATION_TOLERANCE_M:
            nearest = ", ".join(
                f"{value:.4f}" for value in np.round(self.position(place), 4) + 0.0
            )  # + 0.0: no "-0.0000"
            raise ValueError(
                f"{name} at {position.tolist()} m is {distance:.4f} m off the tube (limit "
                f"{LOCATION_TOLERANCE_M} m): the nearest point of the centreline is [{nearest}]"
            )
        return place

    def stretch(
        self, one: ArrayLike | None, other: ArrayLike | None, name: str
    ) -> tuple[float, float]:
        """Return the arc lengths in m, ascending, of the stretch between two positions (3,) in m.

        one: None for the start. other: None for the end. name: as in locate.
        Raises ValueError as locate does.
        """
        start = 0.0 if one is None else self.locate(one, name)
        end = self.length if other is None else self.locate(other, name)
        return min(start, end), max(start, end)

    def carried(self, direction: ArrayLike, arc_length: float, start: float = 0.0) -> np.ndarray:
        """Return the unit vector (3,) that a direction at the arc length `start` in m becomes at
        another one, on either side of it.

        The part of `direction` (3,) across the tube is carried along without twist: it is constant
        on straight segments and turns with the tangent in the plane of each bend.
        Raises ValueError for a direction along the tube.
        """
        tangent = self.direction(start)
        vector = unit_vector(direction)
        vector = unit_vector(vector - (vector @ tangent) * tangent)
        for piece in self.segments if arc_length > start else reversed(self.segments):
            first, last = (
                (min(max(place, piece.begin), piece.end) - piece.begin) / piece.radius
                for place in (start, arc_length)
            )
            if piece.toward is not None and first != last:
                before, after = (
                    np.cos(angle) * piece.toward - np.sin(angle) * piece.tangent
                    for angle in (first, last)
                )
                vector = unit_vector(vector + (vector @ before) * (after - before))
        return vector


def build_centreline(structure: Any) -> Centreline:
    """Return the Centreline of a tube.

    structure: the section `structure` of a configuration, of kind u_tube or path.
    """
    if structure.kind == "u_tube":
        radius, leg = structure.bend_radius_m, structure.leg_length_m
        bend = (np.pi * radius, radius, (1.0, 0.0, 0.0))
        straight = (leg, np.inf, None)
        return _join((-radius, 0.0, 0.0), (0.0, 0.0, 1.0), (straight, bend, straight))
    path: list[Piece] = []
    for segment in structure.segments:
        if segment.kind == "straight":
            path.append((segment.length_m, np.inf, None))
        else:
            length = np.deg2rad(segment.angle_deg) * segment.radius_m
            path.append((length, segment.radius_m, tuple(segment.toward)))
    return _join(tuple(structure.start_m), tuple(structure.start_direction), tuple(path))


@lru_cache(maxsize=8)
def _join(
    start: tuple[float, ...], direction: tuple[float, ...], pieces: tuple[Piece, ...]
) -> Centreline:
    """Return the Centreline of pieces laid end to end. Variants of one tube share it, and the
    points that were located on it.

    start (3,): position of its start, m.
    direction (3,): tangent there.
    pieces: (length in m, radius in m, toward) of each.
    """
    segments = []
    begin, point, tangent = 0.0, np.asarray(start, dtype=float), unit_vector(direction)
    for length, radius, toward in pieces:
        inward = None
        if toward is not None:
            given = np.asarray(toward, dtype=float)
            inward = unit_vector(given - (given @ tangent) * tangent)
        segment = Segment(begin, length, point, tangent, radius, inward)
        segments.append(segment)
        begin = segment.end
        point = segment.position(segment.end)
        tangent = segment.direction(segment.end)
    return Centreline(tuple(segments))
