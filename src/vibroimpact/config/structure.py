"""The keys of the structure (a tube, a chain of masses, matrices or measured modes) and of its
damping.
"""

from typing import Annotated, Literal

from pydantic import Field

from .cross_section import Cross_section
from .fluid import Fluids
from .material import Material
from .quantities import (
    Axis,
    By_kind,
    Coefficient,
    Damping_ratio,
    Direction,
    Frequency_Hz,
    Length,
    Length_m,
    Mass_kg,
    Name,
    Non_negative,
    Not_empty,
    Number,
    Pattern,
    Range,
    Section,
    Stiffness,
    Unit,
    Vector,
    Whole,
)

Rotation_stiffness = Annotated[
    Number, Range("give the stiffness in N m/rad", above=0, at_most=1e15)
]
Angle_deg = Annotated[Number, Range("in degrees: half a turn is 180", above=0, at_most=360)]


class Mesh(Section):
    """The finite-element mesh of the tube. Segment ends and contact points are always nodes."""

    elements_per_span: Annotated[
        Whole, Range("20 elements per span is the stated mesh", at_least=1, at_most=2000)
    ] = Field(
        20,
        description="Elements of each stretch of a straight segment between segment ends and"
        " support edges.",
    )
    elements_per_bend: Annotated[
        Whole, Range("80 elements per bend is the stated mesh", at_least=1, at_most=2000)
    ] = Field(
        80,
        description="Elements of each bend. If supports cut the bend, its parts share the"
        " elements by length.",
    )


class Clamped(Section):
    """An end that neither moves nor rotates."""

    kind: Literal["clamped"] = Field(description="This kind of end.")


class Pinned(Section):
    """An end that does not move and does not twist, but bends freely."""

    kind: Literal["pinned"] = Field(description="This kind of end.")


class Free(Section):
    """An end that is free."""

    kind: Literal["free"] = Field(description="This kind of end.")


class Springs(Section):
    """An end on springs that are equal in all three directions."""

    kind: Literal["springs"] = Field(description="This kind of end.")
    translation_N_per_m: Stiffness = Field(
        description="Stiffness against displacement, in each direction.", examples=[1.0e8]
    )
    rotation_N_m_per_rad: Rotation_stiffness = Field(
        description="Stiffness against rotation, about each axis.", examples=[1.0e5]
    )


Theory = Literal["timoshenko", "euler_bernoulli"]
FLUID = "Still fluids inside and outside the tube."
THEORY = "Beam theory: with shear deformation and rotary inertia (timoshenko) or without."


class UTube(Section):
    """A U-tube in the plane y = 0. Its legs run along z from z = 0 at x = -bend_radius_m and x =
    +bend_radius_m, the apex is on the z axis, and y is out of plane.
    """

    kind: Literal["u_tube"] = Field(description="This kind of structure.")
    theory: Theory = Field("timoshenko", description=THEORY)
    section: Cross_section = Field(description="Cross-section of the tube.")
    material: Material = Field(description="Material of the tube.")
    fluid: Fluids = Field((), description=FLUID)
    leg_length_m: Length_m = Field(
        description="Length of each leg, from its root at z = 0 to the bend.", examples=[0.70]
    )
    bend_radius_m: Length_m = Field(
        description="Radius of the centreline of the half-circular bend.", examples=[0.30]
    )
    mesh: Mesh = Field(Mesh(), description="Finite-element mesh.")
    root: Annotated[Clamped | Pinned | Springs, By_kind] = Field(
        Clamped(kind="clamped"), description="How both roots are held."
    )


class Straight(Section):
    """A straight segment of a path."""

    kind: Literal["straight"] = Field(description="This kind of segment.")
    length_m: Length_m = Field(description="Length.", examples=[1.0])


class Bend(Section):
    """A circular arc of a path. It begins along the tangent of the segment before it."""

    kind: Literal["bend"] = Field(description="This kind of segment.")
    radius_m: Length_m = Field(description="Radius of the centreline.", examples=[0.2])
    angle_deg: Angle_deg = Field(description="Angle of the arc.", examples=[90.0])
    toward: Direction = Field(
        description="Direction that the path turns to: from the beginning of the arc to its"
        " centre. The part along the tangent is ignored.",
        examples=[[0.0, 0.0, 1.0]],
    )


class Path(Section):
    """A tube along any path: straight and bend segments joined end to end with a continuous
    tangent.
    """

    kind: Literal["path"] = Field(description="This kind of structure.")
    theory: Theory = Field("timoshenko", description=THEORY)
    section: Cross_section = Field(description="Cross-section of the tube.")
    material: Material = Field(description="Material of the tube.")
    fluid: Fluids = Field((), description=FLUID)
    start_m: Vector = Field(description="Position of the start.", examples=[[0.0, 0.0, 0.0]])
    start_direction: Direction = Field(
        description="Direction of the tube at the start.", examples=[[1.0, 0.0, 0.0]]
    )
    segments: Annotated[tuple[Annotated[Straight | Bend, By_kind], ...], Not_empty] = Field(
        description="Segments of the path, from its start on."
    )
    mesh: Mesh = Field(Mesh(), description="Finite-element mesh.")
    start: Annotated[Clamped | Pinned | Springs | Free, By_kind] = Field(
        Clamped(kind="clamped"), description="How the start is held."
    )
    end: Annotated[Clamped | Pinned | Springs | Free, By_kind] = Field(
        Clamped(kind="clamped"), description="How the end is held."
    )


class Mass(Section):
    """A mass of a chain. It moves along x."""

    name: Name = Field(description="Name of the mass, and of its point.", examples=["mass"])
    mass_kg: Mass_kg = Field(description="Mass.", examples=[1.0])


class Spring(Section):
    """A linear spring and damper of a chain, between two masses or between a mass and the
    ground.
    """

    between: Annotated[tuple[Name, ...], Length("give two names: masses, or ground", 2)] = Field(
        description="The two ends: names of masses, or `ground`.", examples=[["ground", "mass"]]
    )
    stiffness_N_per_m: Non_negative = Field(0.0, description="Stiffness.", examples=[6.3e4])
    damping_N_s_per_m: Coefficient = Field(0.0, description="Damping coefficient.", examples=[12.0])


class Chain(Section):
    """Masses on a line along x. Each mass is a point of its name with the direction x."""

    kind: Literal["chain"] = Field(description="This kind of structure.")
    masses: Annotated[tuple[Mass, ...], Not_empty] = Field(description="The masses.")
    springs: tuple[Spring, ...] = Field((), description="The springs and dampers.")


MATRIX_FILE = (
    " A file with several arrays must name this one `{name}`, `{letter}` or `{small}`; a Nastran"
    " OP4 file may name it `{letter_op4}GG`, `{letter_op4}AA` and the like. A file with one array"
    " may give it any name."
)


class Matrices(Section):
    """A structure given by its matrices in SI units, in files of NumPy (.npz), MATLAB (.mat),
    MatrixMarket (.mtx) or Nastran (.op4). The matrices are square, symmetric, real and of the same
    size. Paths are relative to the folder in which the study is run.
    """

    kind: Literal["matrices"] = Field(description="This kind of structure.")
    mass: str = Field(
        description="File of the mass matrix, in kg for displacements."
        + MATRIX_FILE.format(name="mass", letter="M", small="m", letter_op4="M"),
        examples=["matrices/mass.mtx"],
    )
    stiffness: str = Field(
        description="File of the stiffness matrix, in N/m for displacements."
        + MATRIX_FILE.format(name="stiffness", letter="K", small="k", letter_op4="K"),
        examples=["matrices/stiffness.mtx"],
    )
    damping: str | None = Field(
        None,
        description="File of a damping matrix, in N s/m for displacements, or null. It is added to"
        " the top-level `damping`."
        + MATRIX_FILE.format(name="damping", letter="C", small="c", letter_op4="B"),
        examples=["matrices/damping.mtx"],
    )
    op4_set: (
        Annotated[
            str,
            Pattern(
                "a set of Nastran, with its number if the file holds several of them, as aa2",
                r"(gg|nn|ff|aa|ll|xx)([1-9]\d?)?",
            ),
        ]
        | None
    ) = Field(
        None,
        description="Which matrices of an OP4 file are read if several would do: the set of"
        " Nastran, `gg`, `nn`, `ff`, `aa`, `ll` or `xx`, and its number if the file holds the"
        " matrices of several structures, as `aa2` of the second.",
        examples=["aa2"],
    )
    points: dict[
        Name,
        dict[Axis, Annotated[Whole, Range("dofs are counted from 0", at_least=0, at_most=10**7)]],
    ] = Field(
        description="Named points: for each point, the degree of freedom (row of the matrices,"
        " counted from 0) that is its displacement along x, y or z. A direction that is left out"
        " does not move. In an OP4 file, the rows are the degrees of freedom of Nastran's set, in"
        " its order.",
        examples=[{"tip": {"x": 0, "y": 1}}],
    )


class MeasuredMode(Section):
    """A measured mode of a structure."""

    frequency_Hz: Frequency_Hz = Field(description="Natural frequency.", examples=[7.3])
    damping_ratio: Annotated[
        Number, Range("a fraction, not per cent: 1.5 % is 0.015", at_least=0, at_most=10), Unit("1")
    ] = Field(description="Damping ratio, as a fraction.", examples=[0.02])
    shape: dict[Name, dict[Axis, Annotated[Number, Unit("kg^-1/2")]]] = Field(
        description="Mode shape: for each named point, its displacement along x, y or z, scaled to"
        " unit modal mass. Other displacements are 0.",
        examples=[{"tip": {"x": 0.31}}],
    )
    residual: bool = Field(
        False,
        description="True for a mode that stands for the modes outside the measured band. Its"
        " frequency has no meaning by itself.",
    )


class Identified(Section):
    """A structure known by its measured modes. Its points are those that the mode shapes name, and
    its damping is that of the modes: the top-level `damping` is not used.
    """

    kind: Literal["identified"] = Field(description="This kind of structure.")
    modes: Annotated[tuple[MeasuredMode, ...], Not_empty] = Field(description="The modes.")


Structure = Annotated[UTube | Path | Chain | Matrices | Identified, By_kind]


class ModalDamping(Section):
    """Damping ratios of the modes of the structure without contact, in the order of their
    frequencies.
    """

    kind: Literal["modal"] = Field(description="This kind of damping.")
    first_ratios: tuple[Damping_ratio, ...] = Field(
        (),
        description="Damping ratios of the first modes, one each, as fractions. Rigid-body modes"
        " are not counted.",
        examples=[[0.015, 0.015]],
    )
    other_ratio: Damping_ratio = Field(
        description="Damping ratio of all other modes, as a fraction.", examples=[0.002]
    )
    mass_coefficient_per_s: Coefficient = Field(
        0.0,
        description="Factor of the mass matrix in a damping matrix that is added, as for a fluid"
        " along the whole tube.",
        examples=[0.5],
    )


class RayleighDamping(Section):
    """The damping matrix C = mass_coefficient_per_s M + stiffness_coefficient_s K."""

    kind: Literal["rayleigh"] = Field(description="This kind of damping.")
    mass_coefficient_per_s: Coefficient = Field(
        description="Factor of the mass matrix M.", examples=[0.5]
    )
    stiffness_coefficient_s: Coefficient = Field(
        description="Factor of the stiffness matrix K.", examples=[1.0e-5]
    )


Damping = Annotated[ModalDamping | RayleighDamping, By_kind]
