"""Finite-element matrices and modes of a rig, out of plane ("y") and in plane ("x")."""

import numpy as np
from scipy.linalg import eigh

from vibroimpact_truth.elements import Mesh
from vibroimpact_truth.geometry import named_places


class Planes:
    """The finite-element matrices of a rig, with its springs, masses, fluid and roots."""

    def __init__(self, rig, element_length=0.036):
        self.rig, self.mesh = rig, Mesh(rig.tube, element_length)
        self.places = named_places(rig.tube)
        self.stiffness, self.mass, self.bare_mass = {}, {}, {}
        for plane in ("y", "x"):
            self.stiffness[plane], self.mass[plane] = self.mesh.matrices(plane, rig.fluid[0])
        for place, direction, value in rig.springs:
            self._add(self.stiffness, place, direction, value)
        for place, value in rig.masses:
            for direction in np.eye(3):
                self._add(self.mass, place, direction, value)
        last = 3 * self.mesh.nodes
        ends = {
            "y": ([0, last - 3], [1, 2, last - 2, last - 1]),
            "x": ([0, 1, last - 3, last - 2], [2, last - 1]),
        }
        self.free = {}
        for plane, (moves, turns) in ends.items():
            self.free[plane] = np.ones(last, bool)
            if rig.root is None:
                self.free[plane][moves + turns] = False
            else:
                self.stiffness[plane][moves, moves] += rig.root[0]
                self.stiffness[plane][turns, turns] += rig.root[1]

    def arc(self, place):
        """Arc length in m of a place: its name, or the arc length itself."""
        return self.places[place] if isinstance(place, str) else float(place)

    def _add(self, matrices, place, direction, value):
        for plane, row in self.rows(place, direction).items():
            if row.any():
                matrices[plane] += value * np.outer(row, row)

    def rows(self, place, direction):
        """{plane: (dof,)} displacement along direction (3,) at a place.

        direction "rx" or "ry": rotation of the root instead.
        """
        size = 3 * self.mesh.nodes
        if isinstance(direction, str):
            rows = {"y": np.zeros(size), "x": np.zeros(size)}
            end = 0 if place == "left_root" else size - 3
            rows["y" if direction == "rx" else "x"][end + (1 if direction == "rx" else 2)] = 1.0
            return rows
        return dict(
            zip(("y", "x"), self.mesh.direction_rows(self.arc(place), direction), strict=True)
        )

    def modes(self, plane, highest=None, extra=()):
        """(mode,) frequencies [Hz] and (dof, mode) mass-normalised shapes up to `highest` Hz.

        extra: (row, N/m) springs.
        """
        free = self.free[plane]
        stiffness = self.stiffness[plane].copy()
        for row, value in extra:
            stiffness += value * np.outer(row, row)
        bounds = None if highest is None else (-1.0, (2.0 * np.pi * highest) ** 2)
        values, vectors = eigh(
            stiffness[np.ix_(free, free)],
            self.mass[plane][np.ix_(free, free)],
            subset_by_value=bounds,
        )
        shapes = np.zeros((len(free), len(values)))
        shapes[free] = vectors
        return np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi), shapes
