"""Beams of campaigns: centreline by arc length, section, supports and places.

All lie in the x-z plane, with y out of plane: a U-tube, and a straight tube or rod along x or z.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np


@dataclass(frozen=True)
class Holder:
    """A gap support as the user knows it.

    arc, height: m, of its middle and along the beam. stiffness: N/m, shared by its contact nodes.
    nodes: edges included. gap_factor: of the record's gap.
    profile: "circle", "lands" (flat) or "lobes"; lobes: how many; angle: rad, of the first, from
    the in-plane direction across the beam towards y.
    """

    name: str
    arc: float
    height: float = 0.030
    stiffness: float = 4.0e6
    nodes: int = 7
    gap_factor: float = 1.0
    profile: str = "circle"
    lobes: int = 2
    angle: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A beam of a round section; SI units, angles in rad.

    wall: half of the diameter for a rod.
    shear_coefficient: inf means no shear and no rotary inertia.
    ends: "clamped", "pinned" (bends freely, does not twist) or "free", of the start and the end.
    """

    outer_diameter: float
    wall: float
    young: float = 2.02e11
    poisson: float = 0.3
    density: float = 8330.0
    shear_coefficient: float = 0.53
    first_damping: float = 0.015
    other_damping: float = 0.002
    ends: tuple = ("clamped", "clamped")

    @property
    def section(self) -> dict:
        """EA [N], EI [N m²], GJ [N m²], kGA [N], mass [kg/m], inertia rho I, polar rho J [kg m]."""
        outer, inner = 0.5 * self.outer_diameter, 0.5 * self.outer_diameter - self.wall
        area, second = pi * (outer**2 - inner**2), 0.25 * pi * (outer**4 - inner**4)
        shear = 0.5 * self.young / (1.0 + self.poisson)
        return {
            "EA": self.young * area,
            "EI": self.young * second,
            "GJ": 2.0 * shear * second,
            "kGA": self.shear_coefficient * shear * area,
            "mass": self.density * area,
            "inertia": self.density * second,
            "polar": 2.0 * self.density * second,
        }

    def across(self, s):
        """(3,) in-plane direction across the beam at s [m], positive along x, or z where x is not.

        With y it spans the section.
        """
        tx, tz = self.tangent(s)
        normal = np.array([tz, 0.0, -tx])
        return normal * np.sign(normal[np.argmax(np.abs(normal))])

    def holder(self, name) -> Holder:
        """The support of a name."""
        return next(holder for holder in self.holders if holder.name == name)

    def plate_nodes(self, name):
        """(node,) arc lengths in m of the contact nodes of a support, upwards on a leg."""
        holder = self.holder(name)
        half = 0.5 * holder.height if holder.nodes > 1 else 0.0
        arcs = np.linspace(holder.arc - half, holder.arc + half, holder.nodes)
        return arcs[::-1] if self.tangent(holder.arc)[1] < 0.0 else arcs

    def with_changes(self, **changes):
        """The beam with some fields changed."""
        return replace(self, **changes)


@dataclass(frozen=True, kw_only=True)
class Tube(Beam):
    """A U-tube with a plate on each leg, roots at x = -+bend_radius, z = 0.

    plate_height: z of the middle of both plates.
    plate_length: height of a plate.
    plate_stiffness: N/m of a plate, shared equally by its contact nodes.
    contact_nodes: per plate, edges included.
    drive_angle: on the bend, from the apex towards the left leg.
    plate_factors: of the gap, left and right.
    """

    leg: float
    bend_radius: float
    plate_height: float
    plate_length: float = 0.030
    plate_stiffness: float = 4.0e6
    contact_nodes: int = 7
    drive_angle: float = pi / 4
    plate_factors: tuple = (1.0, 1.0)

    @property
    def length(self) -> float:
        """Arc length from root to root, m."""
        return 2.0 * self.leg + pi * self.bend_radius

    @property
    def corners(self) -> tuple:
        """Arc lengths in m where the curvature changes."""
        return self.leg, self.length - self.leg

    @property
    def holders(self) -> tuple:
        """The supports."""
        return tuple(
            Holder(
                side,
                self.leg_height(side, self.plate_height),
                self.plate_length,
                self.plate_stiffness,
                self.contact_nodes,
                factor,
            )
            for side, factor in zip(("left", "right"), self.plate_factors, strict=True)
        )

    def position(self, s):
        """(…, 3) position in m at arc length s [m] from the left root."""
        s = np.asarray(s, float)
        # 0 where the bend begins on the left, pi on the right
        angle = np.clip((s - self.leg) / self.bend_radius, 0.0, pi)
        rise = np.where(
            s < self.leg, s, np.where(s > self.length - self.leg, self.length - s, self.leg)
        )
        return np.stack(
            [
                -self.bend_radius * np.cos(angle),
                np.zeros_like(s),
                rise + self.bend_radius * np.sin(angle),
            ],
            axis=-1,
        )

    def tangent(self, s):
        """(…, 2) x and z of the unit tangent at arc length s [m]."""
        angle = np.clip((np.asarray(s, float) - self.leg) / self.bend_radius, 0.0, pi)
        return np.stack([np.sin(angle), np.cos(angle)], axis=-1)

    def bend(self, angle: float) -> float:
        """Arc length in m of a point of the bend.

        angle: rad, from the apex, positive towards the right leg.
        """
        return self.leg + self.bend_radius * (0.5 * pi + angle)

    def leg_height(self, side: str, z: float) -> float:
        """Arc length in m of height z [m] on the "left" or "right" leg."""
        return z if side == "left" else self.length - z

    @property
    def places(self) -> dict:
        """Arc length in m of the places that the model names."""

        def upper(side):  # between the plate and the bend, off the middle
            height = self.plate_height + 0.5227 * (self.leg - self.plate_height)
            return self.leg_height(side, height)

        return {
            "apex": self.bend(0.0),
            "drive": self.bend(-self.drive_angle),
            "bend45_right": self.bend(pi / 4),
            "bend45_left": self.bend(-pi / 4),
            "left_leg_upper": upper("left"),
            "right_leg_upper": upper("right"),
            "left_leg_lower": 0.716 * self.plate_height,
            "right_leg_lower": self.leg_height("right", 0.716 * self.plate_height),
        }


@dataclass(frozen=True, kw_only=True)
class Straight(Beam):
    """A straight tube or rod from the origin along "x" or "z".

    drive: m, place of the force.
    """

    length: float
    axis: str = "z"
    holders: tuple = ()
    drive: float = 0.0

    corners = ()

    def position(self, s):
        """(…, 3) position in m at arc length s [m] from the start."""
        return np.asarray(s, float)[..., None] * np.array(
            [float(self.axis == "x"), 0.0, float(self.axis == "z")]
        )

    def tangent(self, s):
        """(…, 2) x and z of the unit tangent at arc length s [m]."""
        one = np.ones_like(np.asarray(s, float))
        return np.stack([one * (self.axis == "x"), one * (self.axis == "z")], axis=-1)

    @property
    def places(self) -> dict:
        """Arc length in m of the places that the model names: the drive and the middle of spans."""
        marks = [0.0, *(holder.arc for holder in self.holders), self.length]
        middles = {
            f"span_{number}": 0.5 * (a + b)
            for number, (a, b) in enumerate(zip(marks[:-1], marks[1:], strict=True), 1)
            if b > a
        }
        return {"drive": self.drive, **middles}


TUBES = {
    "stand_in": Tube(
        outer_diameter=0.02222, wall=0.00127, leg=0.70, bend_radius=0.30, plate_height=0.35
    ),
    "dev": Tube(
        outer_diameter=0.01905, wall=0.00109, leg=0.625, bend_radius=0.30, plate_height=0.25
    ),
}
