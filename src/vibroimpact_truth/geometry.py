"""The tubes: U-shaped centreline by arc length, section constants, and the tubes of campaigns."""

from dataclasses import dataclass, replace
from math import pi

import numpy as np


@dataclass(frozen=True)
class Tube:
    """A U-tube in the x-z plane, roots at x = -+bend_radius, z = 0; SI units, angles in rad.

    plate_height: z of the middle of both plates.
    plate_length: height of a plate.
    plate_stiffness: N/m of a plate, shared equally by its contact nodes.
    contact_nodes: per plate, edges included.
    drive_angle: on the bend, from the apex towards the left leg.
    shear_coefficient: inf means no shear and no rotary inertia.
    """

    outer_diameter: float
    wall: float
    leg: float
    bend_radius: float
    plate_height: float
    plate_length: float = 0.030
    plate_stiffness: float = 4.0e6
    contact_nodes: int = 7
    young: float = 2.02e11
    poisson: float = 0.3
    density: float = 8330.0
    shear_coefficient: float = 0.53
    drive_angle: float = pi / 4
    first_damping: float = 0.015
    other_damping: float = 0.002

    @property
    def length(self) -> float:
        """Arc length from root to root, m."""
        return 2.0 * self.leg + pi * self.bend_radius

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

    def plate_nodes(self, side: str):
        """(contact_nodes,) arc lengths in m of the contact nodes of a plate, upwards."""
        half = 0.5 * self.plate_length if self.contact_nodes > 1 else 0.0
        heights = np.linspace(
            self.plate_height - half, self.plate_height + half, self.contact_nodes
        )
        return np.array([self.leg_height(side, z) for z in heights])

    def with_changes(self, **changes):
        """The tube with some fields changed."""
        return replace(self, **changes)


TUBES = {
    "stand_in": Tube(
        outer_diameter=0.02222, wall=0.00127, leg=0.70, bend_radius=0.30, plate_height=0.35
    ),
    "dev": Tube(
        outer_diameter=0.01905, wall=0.00109, leg=0.625, bend_radius=0.30, plate_height=0.25
    ),
}


def named_places(tube: Tube) -> dict:
    """Arc length in m of the places of sensors, masses and springs, by name."""

    def upper(side):  # between the plate and the bend, off the middle
        return tube.leg_height(side, tube.plate_height + 0.5227 * (tube.leg - tube.plate_height))

    return {
        "apex": tube.bend(0.0),
        "drive": tube.bend(-tube.drive_angle),
        "bend45_right": tube.bend(pi / 4),
        "bend45_left": tube.bend(-pi / 4),
        "left_leg_upper": upper("left"),
        "right_leg_upper": upper("right"),
        "left_leg_lower": 0.716 * tube.plate_height,
        "right_leg_lower": tube.leg_height("right", 0.716 * tube.plate_height),
    }
