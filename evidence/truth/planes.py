"""Finite-element matrices and modes of a rig, out of plane ("y") and in plane ("x")."""

import numpy as np
from scipy.linalg import eigh

from evidence.truth.elements import Mesh

BEND = 1.0e-3  # m, over which the bending angle of a crack is taken


class Planes:
    """The finite-element matrices of a rig, with its springs, masses, fluid and roots."""

    def __init__(self, rig, element_length=0.036):
        self.rig, self.mesh = rig, Mesh(rig.tube, element_length)
        self.places = rig.tube.places
        self.stiffness, self.mass, self.bare_mass = {}, {}, {}
        for plane in ("y", "x"):
            self.stiffness[plane], self.mass[plane] = self.mesh.matrices(plane, rig.fluid[0])
        for place, direction, value in rig.springs:
            self._add(self.stiffness, place, direction, value)
        for place, value in rig.masses:
            for direction in np.eye(3):
                self._add(self.mass, place, direction, value)
        last = 3 * self.mesh.nodes
        self.free = {plane: np.ones(last, bool) for plane in ("y", "x")}
        for first, end in zip((0, last - 3), rig.tube.ends, strict=True):
            self._hold(first, end)

    def _hold(self, first, end):
        """Hold an end, whose first dof is `first` in both planes, on the root's springs if any."""
        moves, turns = {"y": [0], "x": [0, 1]}, {"y": [1, 2], "x": [2]}
        if end == "pinned":  # only the twist is held, about the axis of a straight beam
            turns = {"y": [1 if self.rig.tube.axis == "x" else 2], "x": []}
        if end == "free":
            return
        for plane in ("y", "x"):
            for dofs, springs in zip((moves, turns), self.rig.root or (None, None), strict=True):
                held = [first + dof for dof in dofs[plane]]
                if springs is None or end == "pinned":
                    self.free[plane][held] = False
                else:
                    self.stiffness[plane][held, held] += springs

    def arc(self, place):
        """Arc length in m of a place: its name, or the arc length itself."""
        return self.places[place] if isinstance(place, str) else float(place)

    def _add(self, matrices, place, direction, value):
        for plane, row in self.rows(place, direction).items():
            if row.any():
                matrices[plane] += value * np.outer(row, row)

    def rows(self, place, direction):
        """{plane: (dof,)} displacement along direction (3,) at a place.

        direction "rx" or "ry": rotation of the root instead; "bend_y" or "bend_x": the bending
        angle over BEND m, out of plane or in plane.
        """
        size = 3 * self.mesh.nodes
        if isinstance(direction, str) and direction.startswith("bend"):
            return self._bending(self.arc(place), direction[-1])
        if isinstance(direction, str):
            rows = {"y": np.zeros(size), "x": np.zeros(size)}
            end = 0 if place == "left_root" else size - 3
            rows["y" if direction == "rx" else "x"][end + (1 if direction == "rx" else 2)] = 1.0
            return rows
        return dict(
            zip(("y", "x"), self.mesh.direction_rows(self.arc(place), direction), strict=True)
        )

    def carried(self, direction):
        """{plane: (dof,)} kg: the mass that moves with all that holds the tube along a direction
        (3,), of the tube and of what is fixed to it; a fluid beside it stays where it is.
        """
        x, y, z = direction
        out = {}
        for plane, along in (("y", (y, 0.0, 0.0)), ("x", (x, z, 0.0))):
            mass = self.mesh.matrices(plane)[1]
            out[plane] = mass @ np.tile(along, self.mesh.nodes)
        for place, value in self.rig.masses:
            for axis, component in zip(np.eye(3), direction, strict=True):
                for plane, row in self.rows(place, axis).items():
                    out[plane] += value * component * row
        return out

    def _bending(self, s, plane):
        """{plane: (dof,)} bending angle over BEND m about s [m]."""
        rows = {"y": np.zeros(3 * self.mesh.nodes), "x": np.zeros(3 * self.mesh.nodes)}
        for sign in (-1.0, 1.0):
            at = s + 0.5 * sign * BEND
            tx, tz = self.rig.tube.tangent(at)
            if plane == "y":
                rows["y"] += sign * (tz * self.mesh.row(at, 1) - tx * self.mesh.row(at, 2))
            else:
                rows["x"] += sign * self.mesh.row(at, 2)
        return rows

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
