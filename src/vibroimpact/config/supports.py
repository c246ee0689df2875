"""The keys of local laws: gap supports, force laws between points, and point masses."""

from typing import Annotated

from pydantic import Field

from .profiles import Circular, Profile
from .quantities import (
    Coefficient,
    Damping_ratio,
    Direction,
    List,
    Mass_kg,
    Name,
    Non_negative,
    Number,
    One,
    One_or_list_of_pairs,
    One_or_more,
    Pair,
    Positive_factor,
    Range,
    Section,
    Stiffness,
    Unit,
    Vector,
    Whole,
)

Height_m = Annotated[Number, Range("in metres? 30 mm is 0.030", above=0, at_most=5)]

Friction = Annotated[
    Number,
    Range("Coulomb's coefficient, 0.2 for steel on steel", at_least=0, at_most=10),
    Unit("1"),
]


class Plate(Section):
    """A flexible plate that carries a support: a mass on a spring and damper in each of the two
    transverse directions, without coupling between them. The contact sees the displacement of the
    structure relative to the plate.
    """

    mass_kg: Mass_kg = Field(
        description="Mass of the plate that moves with the support.", examples=[2.0]
    )
    stiffness_N_per_m: Stiffness = Field(
        description="Stiffness of the plate in each transverse direction.", examples=[1.0e7]
    )
    damping_ratio: Damping_ratio = Field(
        0.02, description="Damping ratio of the plate on its spring, as a fraction."
    )


Preload_N = Annotated[Number, Range("give the force in newtons", above=0, at_most=1e9)]


class PointMass(Section):
    """A mass added at a named point of the structure. It has no rotary inertia."""

    name: Name = Field(description="Name of the mass.", examples=["accelerometer"])
    point: Name = Field(description="Named point of the mass.", examples=["apex"])
    mass_kg: Mass_kg = Field(description="Mass.", examples=[0.02])


class Support(Section):
    """A gap support: contact points evenly spaced over its height, both edges included; a single
    contact point is at the middle. A part that reaches past an end of the tube is cut there.

    On a tube, give at_m and height_m. On any other structure, give point, and other_point if the
    support is between two points; it then has one contact point. The two transverse directions of a
    support on a tube are perpendicular to the tube: the two global axes least aligned with the
    tube, in the order x, y, z, made perpendicular to it. They are x and y if the tube runs along
    z, y and z if it runs along x, x and z if it runs along y. On a bend they are those at the
    middle of the support, made perpendicular to the tube at each contact point. On any other
    structure they are x and y.
    """

    name: Name = Field(description="Name of the support.", examples=["left"])
    at_m: Vector | None = Field(
        None,
        description="Position of the middle of the support, within 5 mm of the centreline. Tubes"
        " only.",
        examples=[[-0.30, 0.0, 0.35]],
    )
    height_m: Height_m | None = Field(
        None,
        description="Height of the support along the tube: its plate, or the length along the tube"
        " over which a bar touches. It must lie within one segment. Tubes only.",
        examples=[0.030],
    )
    points: Annotated[
        Whole,
        Range(
            "five points follow the contact layer over the whole range of stiffness",
            at_least=1,
            at_most=200,
        ),
    ] = Field(5, description="Number of contact points. Tubes only.")
    point: Name | None = Field(
        None,
        description="Named point that the support is at. For structures that are no tube.",
        examples=["mass"],
    )
    other_point: Name | None = Field(
        None,
        description="Second named point: the support then acts on the displacement of point"
        " relative to other_point. Null for a support on the ground.",
        examples=["frame"],
    )
    stiffness_N_per_m: One_or_more[Stiffness] = Field(
        description="Contact stiffness: the total of the support, shared equally by its contact"
        " points, or a list with the stiffness of each.",
        examples=[4.0e6],
    )
    gap_factor: One_or_more[Positive_factor] = Field(
        1.0,
        description="Factor of the gap of the case at this support, or a list with one factor per"
        " contact point. Not used if gap_m is given.",
        examples=[1.1],
    )
    gap_m: Number | None = Field(
        None,
        description="Radial clearance of this support, in place of the gap of the case. With flat"
        " stops it may be 0 or negative: the support then touches or presses at rest.",
        examples=[1.0e-3],
    )
    preload_N: Preload_N | None = Field(
        None,
        description="Force with which each flat land of the support presses the structure at rest,"
        " before constant forces; null for the gap. It is shared by the contact points as the"
        " stiffness is. The interference that it takes follows from the flexibility of structure"
        " and contact, and from the other supports that touch. A centre_offset_m is added to it.",
        examples=[20.0],
    )
    centre_offset_m: Annotated[
        Annotated[Pair, One] | Annotated[tuple[Pair, ...], List], One_or_list_of_pairs
    ] = Field(
        (0.0, 0.0),
        description="Offset of the obstacle's centre from the structure at rest, along the first"
        " and the second transverse direction, or a list with one such pair per contact point.",
        examples=[[0.0, 1.0e-5]],
    )
    damping_N_s_per_m: Coefficient = Field(
        0.0,
        description="Kelvin-Voigt damping c of the contact, total of the support: the force is"
        " max(0, k p + c dp/dt), with p the penetration. It is shared by the contact points as the"
        " stiffness is.",
        examples=[50.0],
    )
    hunt_crossley_s_per_m: Non_negative = Field(
        0.0,
        description="Hunt-Crossley damping h: the elastic force is multiplied by max(0, 1 + h"
        " dp/dt), with p the penetration.",
        examples=[0.5],
    )
    hertz_N_per_m15: Non_negative = Field(
        0.0,
        description="Coefficient H of a Hertzian contact, total of the support: if it is not 0,"
        " the elastic force is H p^1.5 in place of k p. It is shared by the contact points as the"
        " stiffness is.",
        examples=[1.0e9],
    )
    friction: Friction = Field(
        0.0, description="Coulomb friction coefficient of the contact.", examples=[0.2]
    )
    stick_stiffness_ratio: Positive_factor = Field(
        1.0,
        description="Stiffness of the elastic stick spring that regularises friction, as a multiple"
        " of the contact stiffness. Used if friction is not 0.",
    )
    profile: Profile = Field(Circular(kind="circular"), description="Shape of the obstacle.")
    plate: Plate | None = Field(
        None, description="Flexible plate that carries the support; null for a rigid one."
    )


class LocalElement(Section):
    """A force law along one direction, between a named point and the ground or between two named
    points.

    With u the displacement of point along the direction (relative to other_point if there is
    one) and v its rate, the force on the point is -(k u + q u² + c u³ + d v + e |v| v) minus the
    forces of the slider and of the saturating spring; d v may have a limit. Terms that are 0 are
    left out.
    """

    name: Name = Field(description="Name of the element.", examples=["joint"])
    point: Name = Field(description="Named point that the force acts on.", examples=["apex"])
    other_point: Name | None = Field(
        None,
        description="Second named point, which the opposite force acts on; null for the ground.",
        examples=["frame"],
    )
    direction: Direction = Field(
        description="Direction of the force. Its length does not matter.",
        examples=[[0.0, 1.0, 0.0]],
    )
    stiffness_N_per_m: Number = Field(0.0, description="Linear stiffness k.", examples=[2.0e4])
    quadratic_N_per_m2: Number = Field(0.0, description="Quadratic stiffness q.", examples=[1.0e6])
    cubic_N_per_m3: Number = Field(0.0, description="Cubic stiffness c.", examples=[1.0e9])
    damping_N_s_per_m: Number = Field(0.0, description="Damping coefficient d.", examples=[5.0])
    damping_limit_N: Non_negative = Field(
        0.0,
        description="Largest force of the damper, whose force is d v below it; 0 for no limit.",
        examples=[2.0],
    )
    drag_N_s2_per_m2: Non_negative = Field(
        0.0, description="Coefficient e of quadratic drag.", examples=[10.0]
    )
    drag_partner: Name | None = Field(
        None,
        description="Name of an element in another direction at the same point. Its rate w then"
        " counts in the speed of the drag, |v| = sqrt(v² + w²), as for a fluid around a motion in"
        " a plane.",
        examples=["drag_in_plane"],
    )
    slip_limit_N: Non_negative = Field(
        0.0,
        description="Force at which the slider slips (Coulomb friction of constant normal force);"
        " 0 for no slider.",
        examples=[2.0],
    )
    stick_stiffness_N_per_m: Non_negative = Field(
        0.0,
        description="Stiffness of the slider while it sticks. Used if slip_limit_N is not 0.",
        examples=[1.0e5],
    )
    saturation_stiffness_N_per_m: Number = Field(
        0.0,
        description="Stiffness of the saturating spring, whose force is this times u within"
        " +-saturation_limit_N.",
        examples=[1.0e5],
    )
    saturation_limit_N: Non_negative = Field(
        0.0, description="Largest force of the saturating spring.", examples=[3.0]
    )
