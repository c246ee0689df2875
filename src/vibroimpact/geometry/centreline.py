"""The centreline of a tube: straight and bend segments along an arc length, the mesh on it and the
nearest point to a position.
"""

from dataclasses import dataclass

import numpy as np

LOCATION_TOLERANCE_M = 5.0e-3
SAME_PLACE_M = 1.0e-9
ZERO_COMPONENT = 1.0e-13


def unit_vector(vector):
    """Return `vector` (3,) at length 1, with components below 1e-13 set to exactly 0.

    A turn by 180 degrees leaves 1e-16 where a component is 0; exact zeros keep the planes of motion
    exactly uncoupled.
    """
    vector = np.asarray(vector, dtype=float)
    norm = np.linalg.norm(vector)
    if norm == 0.0:
        raise ValueError(
            "a direction of length 0 was given: give three components that are not all 0"
        )
    vector = vector / norm
    vector = np.where(np.abs(vector) < ZERO_COMPONENT, 0.0, vector)
    return vector / np.linalg.norm(vector)


def transverse_directions(tangent):
    """Return (2, 3): two unit vectors perpendicular to `tangent` (3,), made of the global axes
    least aligned with it, in their order.

    A tangent along z gives exactly x and y. Where two global axes are equally aligned, the later
    one is left out.
    """
    aligned = np.abs(tangent)
    left_out = int(np.flatnonzero(aligned > aligned.max() - 1.0e-9)[-1])
    first, second = (axis for axis in range(3) if axis != left_out)
    e1 = np.eye(3)[first] - tangent[first] * tangent
    e1 = unit_vector(e1)
    e2 = np.eye(3)[second] - tangent[second] * tangent
    return np.array([e1, unit_vector(e2 - (e2 @ e1) * e1)])


@dataclass(frozen=True)
class Segment:
    """A straight (radius infinite) or circular piece: begins at arc length `begin` [m], has
    `length` [m].

    start (3,) m, tangent (3,) at its beginning, toward (3,) unit vector from the start to the
    centre of a bend.
    """

    begin: float
    length: float
    start: np.ndarray
    tangent: np.ndarray
    radius: float = np.inf
    toward: np.ndarray | None = None

    @property
    def end(self):
        """Return the arc length of the end in m."""
        return self.begin + self.length

    def position(self, arc_length):
        """Return the position (3,) in m at an arc length in m."""
        along = arc_length - self.begin
        if self.toward is None:
            return self.start + along * self.tangent
        angle = along / self.radius
        return self.start + self.radius * (
            np.sin(angle) * self.tangent + (1.0 - np.cos(angle)) * self.toward
        )

    def direction(self, arc_length):
        """Return the unit tangent (3,) at an arc length in m."""
        if self.toward is None:
            return self.tangent
        angle = (arc_length - self.begin) / self.radius
        return unit_vector(np.cos(angle) * self.tangent + np.sin(angle) * self.toward)

    def nearest(self, position):
        """Return the arc length in m of the point of this segment nearest to `position` (3,) in
        m.
        """
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
    """Segments joined end to end, the tangent continuous; positions along it are arc lengths in m
    from the start.
    """

    segments: tuple[Segment, ...]

    @property
    def length(self):
        """Return the total arc length in m."""
        return self.segments[-1].end

    def segment_at(self, arc_length):
        """Return the Segment that holds an arc length in m (the earlier one at a joint)."""
        return next(
            (piece for piece in self.segments if arc_length <= piece.end + SAME_PLACE_M),
            self.segments[-1],
        )

    def position(self, arc_length):
        """Return the position (3,) in m at an arc length in m."""
        return self.segment_at(arc_length).position(arc_length)

    def direction(self, arc_length):
        """Return the unit tangent (3,) at an arc length in m."""
        return self.segment_at(arc_length).direction(arc_length)

    def locate(self, position, name):
        """Return the arc length in m of the point nearest to `position` (3,) in m.

        Raises ValueError when the centreline is farther than 5 mm: the message gives `name`, the
        distance and the nearest point.
        """
        position = np.asarray(position, dtype=float)
        places = [piece.nearest(position) for piece in self.segments]
        distances = [np.linalg.norm(self.position(place) - position) for place in places]
        best = int(np.argmin(distances))
        if distances[best] > LOCATION_TOLERANCE_M:
            nearest = ", ".join(
                f"{value:.4f}" for value in np.round(self.position(places[best]), 4) + 0.0
            )  # + 0.0: no "-0.0000"
            raise ValueError(
                f"{name} at {position.tolist()} m is {distances[best]:.4f} m off the tube (limit "
                f"{LOCATION_TOLERANCE_M} m): the nearest point of the centreline is [{nearest}]"
            )
        return places[best]


def build_centreline(structure):
    """Return the Centreline of `structure` (config: kind u_tube with leg_length_m and
    bend_radius_m, or path with its segments).
    """
    if structure.kind == "u_tube":
        radius, leg = structure.bend_radius_m, structure.leg_length_m
        pieces = [
            (leg, np.inf, None),
            (np.pi * radius, radius, [1.0, 0.0, 0.0]),
            (leg, np.inf, None),
        ]
        return _join([-radius, 0.0, 0.0], [0.0, 0.0, 1.0], pieces)
    pieces = []
    for segment in structure.segments:
        if segment.kind == "straight":
            pieces.append((segment.length_m, np.inf, None))
        else:
            pieces.append(
                (np.deg2rad(segment.angle_deg) * segment.radius_m, segment.radius_m, segment.toward)
            )
    return _join(structure.start_m, structure.start_direction, pieces)


def _join(start, direction, pieces):
    """Return the Centreline of `pieces` (length m, radius m, toward) laid end to end from `start`
    (3,) m along `direction` (3,).
    """
    segments = []
    begin, point, tangent = 0.0, np.asarray(start, dtype=float), unit_vector(direction)
    for length, radius, toward in pieces:
        if toward is not None:
            toward = np.asarray(toward, dtype=float)
            toward = unit_vector(toward - (toward @ tangent) * tangent)
        segment = Segment(begin, length, point, tangent, radius, toward)
        segments.append(segment)
        begin = segment.end
        point = segment.position(segment.end)
        tangent = segment.direction(segment.end)
    return Centreline(tuple(segments))


def mesh_arc_lengths(centreline, mesh, supports):
    """Return (node,) arc lengths in m of the mesh nodes, ascending.

    mesh: elements_per_span, elements_per_bend. supports: one (contact_point,) array of arc lengths
    in m per support. Segment ends and contact points are nodes; neighbouring contact points of a
    support are joined by one element; a stretch of a straight segment between supports or segment
    ends has `elements_per_span` elements; a whole bend has `elements_per_bend`, shared by length
    where supports cut it.
    """
    fixed = [
        0.0,
        *(piece.end for piece in centreline.segments),
        *(place for points in supports for place in points),
    ]
    breaks = [0.0]
    for place in sorted(fixed):
        if place - breaks[-1] > SAME_PLACE_M:
            breaks.append(place)
    nodes = [0.0]
    for left, right in zip(breaks[:-1], breaks[1:], strict=True):
        count = _elements_between(centreline, mesh, supports, left, right)
        nodes.extend(left + (right - left) * np.arange(1, count) / count)
        nodes.append(right)
    return np.array(nodes)


def _elements_between(centreline, mesh, supports, left, right):
    """Return the number of elements of the stretch from `left` to `right` (arc lengths in m)."""
    if any(
        points[0] < right - SAME_PLACE_M and left + SAME_PLACE_M < points[-1] for points in supports
    ):
        return 1
    segment = centreline.segment_at(0.5 * (left + right))
    if segment.toward is None:
        return mesh.elements_per_span
    return max(1, int(np.ceil(mesh.elements_per_bend * (right - left) / segment.length - 1.0e-6)))
