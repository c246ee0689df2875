"""Places at which a channel may sit, and how the modes move there: any on a tube, the named points
of another structure. A place is one number: an arc length in m, or the number of a point.
"""

from __future__ import annotations

import numpy as np
from scipy import interpolate

from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.reading import check_config
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.observation.attached_model import attach
from vibroimpact.observation.named_places import point_at

from .linearised import linearised
from .workbench import Workbench

ALONG = 97  # places along the tube at which shapes are computed; between them splines
TRIED = 241  # places along the tube that a channel is tried at
NEARBY_M, NEARBY = 0.02, 41  # about the best of them, and how many places there


class TubePlaces:
    """Places along the tube of a Workbench. tried (place,): where a channel is tried."""

    def __init__(self, bench: Workbench) -> None:
        self._line = build_centreline(bench.config.structure)
        self.tried = np.linspace(0.0, self._line.length, TRIED)
        arcs = np.linspace(0.0, self._line.length, ALONG)
        shapes = _shapes(bench, [self._line.position(arc) for arc in arcs])
        self.shapes = interpolate.CubicSpline(arcs, shapes)

    def about(self, place: float) -> np.ndarray:
        """Return (place,): those near one of the tried ones."""
        arcs = place + np.linspace(-NEARBY_M, NEARBY_M, NEARBY)
        return arcs[(arcs >= 0.0) & (arcs <= self._line.length)]

    def at(self, position: np.ndarray, name: str) -> float:
        """Return the place of a position (3,) in m; name: what is there, for the message."""
        return self._line.locate(position, name)

    def position(self, place: float) -> np.ndarray:
        """Return (3,) m."""
        return self._line.position(place)

    def apart_m(self, one: float, other: float) -> float:
        """Return the distance in m of two places along the tube."""
        return abs(one - other)


class PointPlaces:
    """The named points of the structure of a Workbench, as TubePlaces."""

    def __init__(self, bench: Workbench) -> None:
        self._points = bench.config.points
        self._names = [*self._points]
        self.tried = np.arange(len(self._names), dtype=float)
        self._shapes = _shapes(bench, [*self._points.values()])

    def shapes(self, places: np.ndarray | float) -> np.ndarray:
        """Return (..., direction, mode) displacements along x, y, z of all modes at places."""
        return self._shapes[np.asarray(places, int)]

    def about(self, place: float) -> np.ndarray:
        """Return (place,): the tried one alone."""
        return np.array([place])

    def at(self, position: np.ndarray, name: str) -> float:
        """Return the place of a position (3,) in m; name: what is there, for the message."""
        return float(self._names.index(point_at(self._points, position, name)))

    def position(self, place: float) -> np.ndarray:
        """Return (3,) m."""
        return np.array(self._points[self._names[int(place)]])

    def apart_m(self, one: float, other: float) -> float:
        """Return the distance in m of two places."""
        return float(np.linalg.norm(self.position(one) - self.position(other)))


def channel_places(bench: Workbench) -> TubePlaces | PointPlaces:
    """Return the places of the structure of a Workbench."""
    tube = bench.config.structure.kind in TUBES
    return TubePlaces(bench) if tube else PointPlaces(bench)


def _shapes(bench, positions):
    """Return (place, direction, mode) displacements along x, y, z of all modes at positions
    [(3,)] in m.
    """
    count = len(positions)
    points = np.repeat(positions, 3, axis=0)
    there = bench.campaign.drop_dims("channel").assign(
        channel_point=(("channel", "xyz"), points),
        channel_direction=(("channel", "xyz"), np.tile(np.eye(3), (count, 1))),
        channel_name=("channel", [f"along_{number}" for number in range(len(points))]),
        channel_kind=("channel", ["displacement"] * len(points)),
    )
    model = linearised(attach(check_config(bench.values, "model"), there))
    # the same sign of each mode shape in both models
    sign = np.sign(np.sum(model.drive_shapes * bench.bare.drive_shapes, axis=1))
    shapes = (model.sensor_shapes * np.where(sign == 0.0, 1.0, sign)[:, None]).T
    return shapes.reshape(count, 3, -1)
