"""The keys of a support's profile: the shape of the obstacle at the tube."""

from typing import Annotated, Any, Literal

from pydantic import Field

from .quantities import By_kind, Direction, Non_negative, Not_empty, Number, Range, Section, Whole


def _angle(what: str) -> Any:
    """Return the declaration of an angle_deg."""
    told = (
        f"{what}, in degrees from the support's first transverse direction towards the second; null"
        " where normal gives it."
    )
    return Field(None, description=told, examples=[30.0])


def _normal(what: str) -> Any:
    """Return the declaration of a normal."""
    told = (
        f"{what}, as a vector in global axes across the tube, from the obstacle's centre; null if"
        " angle_deg gives it. On a bend it is known without knowing the transverse directions."
    )
    return Field(None, description=told, examples=[[0.0, 1.0, 0.0]])


class Circular(Section):
    """A circular obstacle: contact begins when the distance from its centre exceeds the gap."""

    kind: Literal["circular"] = Field(description="This kind of profile.")


class Drilled(Section):
    """A drilled hole: another name of `circular`."""

    kind: Literal["drilled"] = Field(description="This kind of profile.")


class Planes(Section):
    """Flat stops, each at the distance of the gap, plus its extra gap, from the obstacle's centre.
    The penetration of a stop is n·d - gap, with n its normal and d the displacement from the
    obstacle's centre. One stop alone is one-sided.
    """

    kind: Literal["planes"] = Field(description="This kind of profile.")
    normals_deg: Annotated[tuple[Number, ...], Not_empty] = Field(
        description="Directions of the stops as seen from the obstacle's centre, one angle each."
        " Angles count from the support's first transverse direction (0) towards the second (90): a"
        " stop at 0 limits motion in the positive sense of the first direction, a stop at 180 in"
        " the negative sense.",
        examples=[[0.0, 180.0]],
    )
    extra_gap_m: tuple[Non_negative, ...] = Field(
        (),
        description="Distance of each stop beyond the gap, one value per stop; none for 0. With it"
        " the stops are the table of an outline: bars with unequal clearances, worn lands.",
        examples=[[0.0, 1.0e-4]],
    )


class Lobes(Section):
    """A foliate obstacle. Contact begins at the distance R(theta) = gap + depth_m (1 - cos(count
    (theta - angle_deg))) / 2 from its centre, with theta counted from the support's first
    transverse direction towards the second. The force is normal to this profile.
    """

    kind: Literal["lobes"] = Field(description="This kind of profile.")
    count: Annotated[Whole, Range("a quadrifoil has 4", at_least=2, at_most=24)] = Field(
        description="Number of lands, the places of the smallest R: 3 for a trefoil, 4 for a"
        " quadrifoil.",
        examples=[4],
    )
    depth_m: Non_negative = Field(
        description="Largest minus smallest R: the clearance is the gap at a land and gap +"
        " depth_m midway between two lands.",
        examples=[2.0e-3],
    )
    angle_deg: Number = Field(
        0.0,
        description="Direction of the first land, counted from the first transverse direction"
        " towards the second.",
        examples=[45.0],
    )


class Broached(Section):
    """A broached hole: lands evenly spaced round the tube, three in a trefoil, four in a
    quadrifoil. The lands are flat, as in `planes`, or rounded, as in `lobes`, if depth_m is
    given. Give normal or angle_deg.
    """

    kind: Literal["broached"] = Field(description="This kind of profile.")
    lands: Annotated[
        Whole, Range("a trefoil has 3 lands, a quadrifoil 4", at_least=3, at_most=24)
    ] = Field(description="Number of lands.", examples=[4])
    normal: Direction | None = _normal("Direction of the first land")
    angle_deg: Number | None = _angle("Direction of the first land")
    depth_m: (
        Annotated[Number, Range("in metres; null for flat lands", above=0, at_most=1)] | None
    ) = Field(
        None,
        description="Depth of the lobes between rounded lands, see `lobes`; null for flat lands.",
        examples=[2.0e-3],
    )


class Bars(Section):
    """Flat bars at the tube, such as anti-vibration bars. Contact acts along their normal only,
    in the plane across the tube; a bar is taken to be longer than the tube moves along it. Give
    normal or angle_deg.
    """

    kind: Literal["bars"] = Field(description="This kind of profile.")
    normal: Direction | None = _normal("Direction of the bar that limits motion in its sense")
    angle_deg: Number | None = _angle("Direction of the bar that limits motion in its sense")
    sides: Literal["both", "one"] = Field(
        "both",
        description="`both` for a pair of bars on opposite sides of the tube, each at the gap, or"
        " `one` for the single bar in the direction given.",
    )


class Lattice(Section):
    """An egg-crate lattice: two pairs of flat bars at right angles to each other. Give normal or
    angle_deg.
    """

    kind: Literal["lattice"] = Field(description="This kind of profile.")
    normal: Direction | None = _normal("Normal of the first pair of bars")
    angle_deg: Number | None = _angle("Normal of the first pair of bars")
    spacing_m: Non_negative = Field(
        0.0,
        description="Distance along the tube between the middles of the two pairs, the first pair"
        " nearer to the tube's start; at_m is midway. 0 for bars that cross at the same height."
        " Each pair is height_m high and has all the contact points and the whole stiffness of the"
        " support. Tubes only.",
        examples=[0.05],
    )


Profile = Annotated[Circular | Drilled | Planes | Lobes | Broached | Bars | Lattice, By_kind]


def has_flat_lands(profile: Any) -> bool:
    """Return whether a profile meets the tube with flat lands only."""
    return profile.kind in ("planes", "bars", "lattice") or (
        profile.kind == "broached" and profile.depth_m is None
    )
