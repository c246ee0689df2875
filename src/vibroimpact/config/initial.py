"""The keys of the state at the start of a run."""

from typing import Annotated, Literal

from pydantic import Field

from .quantities import Axis, By_kind, Name, Number, Range, Section, Unit, Vector, Whole

ABOUT = "Point that the rotation is about."
ROTATION = "Rotation about the x, y and z axes through about_m"
NUMBER = (
    "Number of the mode, counted from 1 in the order of the frequencies, among those that move the"
    " point along the direction. The modes are those of the structure without contact."
)
AT_M = Field(description="Position, within 5 mm of the centreline.", examples=[[0.0, 0.0, 0.5]])
VALUES = Field(description="The values, the first at the start of the tube, the last at its end.")
Mode_number = Annotated[Whole, Range("modes are counted from 1", at_least=1, at_most=10**4)]
Amplitude = Annotated[
    Number, Range("give the amplitude, with its sign", at_least=-100, at_most=100)
]


class RigidDisplacement(Section):
    """A displacement as of a rigid body: u(p) = translation_m + rotation_rad x (p - about_m)."""

    kind: Literal["rigid"] = Field(description="This kind of field.")
    translation_m: Vector = Field(
        (0.0, 0.0, 0.0), description="Displacement along x, y and z.", examples=[[1.0e-3, 0.0, 0.0]]
    )
    rotation_rad: Annotated[Vector, Unit("rad")] = Field(
        (0.0, 0.0, 0.0), description=f"{ROTATION}, small.", examples=[[0.0, 1.0e-3, 0.0]]
    )
    about_m: Vector = Field((0.0, 0.0, 0.0), description=ABOUT)


class RigidVelocity(Section):
    """A velocity as of a rigid body: v(p) = translation_m_per_s + rotation_rad_per_s x
    (p - about_m). A velocity that grows along the tube from a pinned end is a rotation about it.
    """

    kind: Literal["rigid"] = Field(description="This kind of field.")
    translation_m_per_s: Vector = Field(
        (0.0, 0.0, 0.0), description="Velocity along x, y and z.", examples=[[0.1, 0.0, 0.0]]
    )
    rotation_rad_per_s: Annotated[Vector, Unit("rad/s")] = Field(
        (0.0, 0.0, 0.0), description=f"{ROTATION}, per second.", examples=[[0.0, -3.8, 0.0]]
    )
    about_m: Vector = Field((0.0, 0.0, 0.0), description=ABOUT)


class Mode(Section):
    """The shape of a mode, and where its amplitude is given."""

    kind: Literal["mode"] = Field(description="This kind of field.")
    number: Mode_number = Field(description=NUMBER, examples=[1])
    point: Name = Field(
        description="Named point at which the amplitude is given.", examples=["tip"]
    )
    direction: Axis = Field(description="Direction of the amplitude.", examples=["x"])


class ModeDisplacement(Mode):
    """A displacement in the shape of a mode."""

    amplitude_m: Amplitude = Field(
        description="Displacement of the point along the direction.", examples=[1.0e-3]
    )


class ModeVelocity(Mode):
    """A velocity in the shape of a mode."""

    amplitude_m_per_s: Amplitude = Field(
        description="Velocity of the point along the direction.", examples=[0.1]
    )


class PlaceDisplacement(Section):
    """The displacement of a tube at a place."""

    at_m: Vector = AT_M
    displacement_m: Vector = Field(
        description="Displacement along x, y and z.", examples=[[1.0e-3, 0.0, 0.0]]
    )


class PlaceVelocity(Section):
    """The velocity of a tube at a place."""

    at_m: Vector = AT_M
    velocity_m_per_s: Vector = Field(
        description="Velocity along x, y and z.", examples=[[0.1, 0.0, 0.0]]
    )


class PlacesDisplacement(Section):
    """Displacements of a tube at places from its start to its end, with a cubic spline along the
    arc length between them. At a clamped end the spline has no slope.
    """

    kind: Literal["places"] = Field(description="This kind of field.")
    values: Annotated[tuple[PlaceDisplacement, ...], Field(min_length=2)] = VALUES


class PlacesVelocity(Section):
    """Velocities of a tube at places from its start to its end, with a cubic spline along the arc
    length between them. At a clamped end the spline has no slope.
    """

    kind: Literal["places"] = Field(description="This kind of field.")
    values: Annotated[tuple[PlaceVelocity, ...], Field(min_length=2)] = VALUES


class Initial(Section):
    """The state at the start of a run. Other parts are at rest at 0, or at static equilibrium
    if a support presses.
    """

    displacement_m: dict[Name, dict[Axis, Number]] = Field(
        {},
        description="Initial displacement of named points along x, y or z. For chains and"
        " matrices only.",
        examples=[{"mass": {"x": 1.0e-3}}],
    )
    velocity_m_per_s: dict[Name, dict[Axis, Number]] = Field(
        {},
        description="Initial velocity of named points along x, y or z. For chains and matrices"
        " only.",
        examples=[{"mass": {"x": 0.1}}],
    )
    displacement: (
        Annotated[RigidDisplacement | ModeDisplacement | PlacesDisplacement, By_kind] | None
    ) = Field(
        None,
        description="Initial displacement of the whole structure as a field. `rigid` and `places`"
        " are for tubes.",
    )
    velocity: Annotated[RigidVelocity | ModeVelocity | PlacesVelocity, By_kind] | None = Field(
        None,
        description="Initial velocity of the whole structure as a field. `rigid` and `places` are"
        " for tubes.",
    )
    base_displacement_m: Number = Field(
        0.0,
        description="Initial displacement of the base along the direction of the base motion. Used"
        " if excitation.obstacles is `fixed`.",
    )
    base_velocity_m_per_s: Number = Field(
        0.0,
        description="Initial velocity of the base along the direction of the base motion. Used"
        " if excitation.obstacles is `fixed`.",
    )
