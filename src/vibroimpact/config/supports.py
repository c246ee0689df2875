"""What a configuration says about local laws: supports, elements between points, and the initial
state.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .quantities import (
    Axis,
    Coefficient,
    Damping_ratio,
    Height_m,
    Name,
    Number,
    Pair,
    Positive_factor,
    Section,
    Stiffness,
    Vector,
    choice,
    count,
    one_or_list,
    within,
)

Friction = Annotated[
    Number, within("Coulomb's coefficient, 0.2 for steel on steel", at_least=0, at_most=10)
]
Non_negative = Annotated[Number, within("give 0 for none", at_least=0)]


class Circular(Section):
    """A circular obstacle round the centre."""

    kind: Literal["circular"]


class Planes(Section):
    """Flat stops: their outward normals in degrees from the support's first transverse direction.
    One angle is a one-sided stop.
    """

    kind: Literal["planes"]
    normals_deg: Annotated[tuple[Number, ...], Field(min_length=1)]


class Lobes(Section):
    """A foliate obstacle r(theta) = gap + depth_m (1 - cos(count (theta - angle))) / 2."""

    kind: Literal["lobes"]
    count: count(2, 24, "a quadrifoil has 4")
    depth_m: Non_negative
    angle_deg: Number = 0.0


class Plate(Section):
    """What carries a support, where it gives way: a mass on a spring and damper in both transverse
    directions.
    """

    mass_kg: Positive_factor
    stiffness_N_per_m: Stiffness
    damping_ratio: Damping_ratio = 0.02


class PointMass(Section):
    """A mass at a named point of the structure."""

    name: Name
    point: Name
    mass_kg: Positive_factor


class Support(Section):
    """A gap support: contact points evenly spaced over its height, both edges included (one point:
    its middle).

    On a tube it is at at_m and height_m high; on a chain or on matrices it is at a named point, or
    between it and other_point. gap_m: clearance of this support in place of the grid's. Stiffness
    and damping are totals, shared by the points, or lists, one per point.
    """

    name: Name
    at_m: Vector | None = None
    height_m: Height_m | None = None
    points: count(
        1, 200, "five points follow the contact layer over the whole range of stiffness"
    ) = 5
    point: Name | None = None
    other_point: Name | None = None
    stiffness_N_per_m: one_or_list(Stiffness, tuple[Stiffness, ...])
    gap_factor: one_or_list(Positive_factor, tuple[Positive_factor, ...]) = 1.0
    gap_m: Number | None = None
    centre_offset_m: one_or_list(Pair, tuple[Pair, ...], depth=2) = (0.0, 0.0)
    damping_N_s_per_m: Coefficient = 0.0
    hunt_crossley_s_per_m: Non_negative = 0.0
    hertz_N_per_m15: Non_negative = 0.0
    friction: Friction = 0.0
    stick_stiffness_ratio: Positive_factor = 1.0
    profile: choice(Circular, Planes, Lobes) = Circular(kind="circular")
    plate: Plate | None = None


class LocalElement(Section):
    """A force law along a direction, between a named point and the ground or between two named
    points; terms add up.

    drag_partner: name of the element, across this one, whose rate counts in the speed that drags:
    |v| of a motion in a plane.
    """

    name: Name
    point: Name
    other_point: Name | None = None
    direction: Vector
    stiffness_N_per_m: Number = 0.0
    quadratic_N_per_m2: Number = 0.0
    cubic_N_per_m3: Number = 0.0
    damping_N_s_per_m: Number = 0.0
    drag_N_s2_per_m2: Non_negative = 0.0
    drag_partner: Name | None = None
    slip_limit_N: Non_negative = 0.0
    stick_stiffness_N_per_m: Non_negative = 0.0
    saturation_stiffness_N_per_m: Number = 0.0
    saturation_limit_N: Non_negative = 0.0


class Initial(Section):
    """The state at the start of a run: displacement and velocity of named points by direction;
    everything else at rest.
    """

    displacement_m: dict[Name, dict[Axis, Number]] = {}
    velocity_m_per_s: dict[Name, dict[Axis, Number]] = {}
    base_displacement_m: Number = 0.0
    base_velocity_m_per_s: Number = 0.0
