"""What a configuration says about the structure: centreline, section, material, ends, or masses and
matrices; and its damping.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .quantities import (
    Angle_deg,
    Axis,
    Coefficient,
    Damping_ratio,
    Density,
    Diameter_m,
    Frequency_Hz,
    Length_m,
    Name,
    Number,
    Poisson_ratio,
    Positive_factor,
    Rotation_stiffness,
    Section,
    Shear_coefficient,
    Stiffness,
    Vector,
    Wall_m,
    Youngs_modulus_Pa,
    choice,
    count,
    row,
    within,
)


class TubeSection(Section):
    """Cross-section of the tube; shear_coefficient is Cowper's, used by the Timoshenko theory
    only.
    """

    outer_diameter_m: Diameter_m
    wall_thickness_m: Wall_m
    shear_coefficient: Shear_coefficient = 0.53


class Material(Section):
    """Linear elastic material."""

    young_modulus_Pa: Youngs_modulus_Pa
    poisson_ratio: Poisson_ratio
    density_kg_per_m3: Density


class Mesh(Section):
    """Number of elements of a span (stretch of a straight segment between ends and support edges)
    and of a bend.
    """

    elements_per_span: count(1, 2000, "20 elements per span is the stated mesh") = 20
    elements_per_bend: count(1, 2000, "80 elements per bend is the stated mesh") = 80


class Clamped(Section):
    """An end that neither moves nor turns."""

    kind: Literal["clamped"]


class Pinned(Section):
    """An end that does not move and does not twist, but bends freely."""

    kind: Literal["pinned"]


class Free(Section):
    """An end that is not held."""

    kind: Literal["free"]


class Springs(Section):
    """An end on springs, the same in all three directions."""

    kind: Literal["springs"]
    translation_N_per_m: Stiffness
    rotation_N_m_per_rad: Rotation_stiffness


class UTube(Section):
    """A U-tube: legs along z at x = -+bend_radius_m from z = 0, apex on the z axis; out of plane is
    y.
    """

    kind: Literal["u_tube"]
    theory: Literal["timoshenko", "euler_bernoulli"] = "timoshenko"
    section: TubeSection
    material: Material
    leg_length_m: Length_m
    bend_radius_m: Length_m
    mesh: Mesh = Mesh()
    root: choice(Clamped, Pinned, Springs) = Clamped(kind="clamped")


class Straight(Section):
    """A straight stretch of a path."""

    kind: Literal["straight"]
    length_m: Length_m


class Bend(Section):
    """A circular arc of a path, turning towards the direction `toward`."""

    kind: Literal["bend"]
    radius_m: Length_m
    angle_deg: Angle_deg
    toward: Vector


class Path(Section):
    """A centreline of straight and bend segments, tangent to each other."""

    kind: Literal["path"]
    theory: Literal["timoshenko", "euler_bernoulli"] = "timoshenko"
    section: TubeSection
    material: Material
    start_m: Vector
    start_direction: Vector
    segments: Annotated[tuple[choice(Straight, Bend), ...], Field(min_length=1)]
    mesh: Mesh = Mesh()
    start: choice(Clamped, Pinned, Springs, Free) = Clamped(kind="clamped")
    end: choice(Clamped, Pinned, Springs, Free) = Clamped(kind="clamped")


class Mass(Section):
    """A mass of a chain; it moves along x."""

    name: Name
    mass_kg: Positive_factor


class Spring(Section):
    """A spring and damper of a chain, between two masses, or between one and the ground."""

    between: row(Name, 2, "give two names: masses, or ground")
    stiffness_N_per_m: Coefficient = 0.0
    damping_N_s_per_m: Coefficient = 0.0


class Chain(Section):
    """Masses on a line, each a point of its name with the direction x."""

    kind: Literal["chain"]
    masses: Annotated[tuple[Mass, ...], Field(min_length=1)]
    springs: tuple[Spring, ...] = ()


class Matrices(Section):
    """A structure given by its matrices, in files (.npz, .mat, MatrixMarket .mtx or Nastran .op4),
    in SI units; points: name -> direction -> dof, from 0.

    In files with several arrays the one named mass, stiffness or damping is taken; in .op4 files
    also MGG, KGG, BGG, MAA, KAA, BAA and the like, whose dofs are the rows of Nastran's set, in its
    order.
    """

    kind: Literal["matrices"]
    mass: str
    stiffness: str
    damping: str | None = None
    points: dict[Name, dict[Axis, count(0, 10**7, "dofs are counted from 0")]]


class MeasuredMode(Section):
    """A mode of a measured structure: shape {point: {direction: displacement}} in kg^-1/2, scaled
    by the drive point; zero where left out.

    residual: it stands for what lies outside the measured band, and its frequency means nothing by
    itself.
    """

    frequency_Hz: Frequency_Hz
    damping_ratio: Annotated[
        Number, within("a fraction, not per cent: 1.5 % is 0.015", at_least=0, at_most=10)
    ]
    shape: dict[Name, dict[Axis, Number]]
    residual: bool = False


class Identified(Section):
    """A structure known by its measured modes; its points are those that the shapes name, and its
    damping is that of the modes.
    """

    kind: Literal["identified"]
    modes: Annotated[tuple[MeasuredMode, ...], Field(min_length=1)]


Structure = choice(UTube, Path, Chain, Matrices, Identified)


class ModalDamping(Section):
    """Damping ratios of the free modes: the first ones one by one, then all others;
    mass_coefficient M on top, as a fluid along the tube gives.
    """

    kind: Literal["modal"]
    first_ratios: tuple[Damping_ratio, ...] = ()
    other_ratio: Damping_ratio
    mass_coefficient_per_s: Coefficient = 0.0


class RayleighDamping(Section):
    """C = mass_coefficient M + stiffness_coefficient K."""

    kind: Literal["rayleigh"]
    mass_coefficient_per_s: Coefficient
    stiffness_coefficient_s: Coefficient


Damping = choice(ModalDamping, RayleighDamping)
