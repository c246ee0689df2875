"""The keys of the cross-section of a tube or a bar."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from .quantities import (
    Area_m2,
    Diameter_m,
    Direction,
    Second_moment,
    Section,
    Shear_coefficient,
    Two_axes,
    Wall_m,
)

SHEAR = "Shear coefficient. Only the Timoshenko theory uses it."
COWPER = f"{SHEAR} Null for Cowper's (1966), by Poisson's ratio."
FIRST_AXIS = (
    "Direction of the section's first axis at the start of the tube; the part along the tube is"
    " ignored. The second axis is the tube's direction times the first (right-handed). Along the"
    " tube the axes turn with the bends and do not twist. Null for the first of the two transverse"
    " directions at the start, as those of a support: of x, y and z, the two least along the tube."
)
FIRST_AXIS_FIELD = Field(None, description=FIRST_AXIS, examples=[[0.0, 1.0, 0.0]])


class TubeSection(Section):
    """A circular tube. It is the default: its `kind` may be left out."""

    kind: Literal["tube"] = Field("tube", description="This kind of cross-section.")
    outer_diameter_m: Diameter_m = Field(description="Outer diameter.", examples=[0.02222])
    wall_thickness_m: Wall_m = Field(
        description="Wall thickness, less than half the outer diameter.", examples=[0.00127]
    )
    shear_coefficient: Shear_coefficient = Field(
        0.53,
        description="Shear coefficient after Cowper (1966). Only the Timoshenko theory uses it.",
    )


class RoundSection(Section):
    """A solid circle, as of a rod."""

    kind: Literal["round"] = Field(description="This kind of cross-section.")
    diameter_m: Diameter_m = Field(description="Diameter.", examples=[0.0095])
    shear_coefficient: Shear_coefficient | None = Field(None, description=COWPER, examples=[0.89])


class RectangleSection(Section):
    """A solid rectangle, as of a bar or a blade."""

    kind: Literal["rectangle"] = Field(description="This kind of cross-section.")
    sides_m: Annotated[tuple[Diameter_m, ...], Two_axes] = Field(
        description="Sides along the first and the second axis.", examples=[[0.010, 0.040]]
    )
    first_axis: Direction | None = FIRST_AXIS_FIELD
    shear_coefficient: Shear_coefficient | None = Field(None, description=COWPER, examples=[0.85])


class GeneralSection(Section):
    """Any cross-section, by its constants. The two axes are its principal axes, and its shear
    centre is its centroid.
    """

    kind: Literal["general"] = Field(description="This kind of cross-section.")
    area_m2: Area_m2 = Field(description="Area of the material.", examples=[4.0e-4])
    second_moments_m4: Annotated[tuple[Second_moment, ...], Two_axes] = Field(
        description="Second moments of area that resist deflection along the first and the second"
        " axis: the integrals of the squared distance along that axis.",
        examples=[[3.33e-9, 5.33e-8]],
    )
    torsion_constant_m4: Second_moment = Field(
        description="Torsion constant: the torque over shear modulus and twist per length.",
        examples=[1.12e-8],
    )
    shear_coefficients: Annotated[tuple[Shear_coefficient, ...], Two_axes] = Field(
        description="Shear areas over the area, for deflection along the first and the second axis."
        " Only the Timoshenko theory uses them.",
        examples=[[0.85, 0.85]],
    )
    outer_fibres_m: Annotated[tuple[Diameter_m, ...], Two_axes] = Field(
        description="Distances of the outermost fibres from the centroid along the first and the"
        " second axis. Stresses are those at the corners of the rectangle that they span.",
        examples=[[0.005, 0.020]],
    )
    first_axis: Direction | None = FIRST_AXIS_FIELD
    enclosed_area_m2: Area_m2 | None = Field(
        None,
        description="Area inside the outline, hollow included; null for a solid section. Only"
        " fluids use it.",
        examples=[4.0e-4],
    )


def _kind_of_section(value: Any) -> str:
    """Return the kind of a cross-section; tube if it says none."""
    kind = value.get("kind", "tube") if isinstance(value, dict) else getattr(value, "kind", "tube")
    return str(kind)


Cross_section = Annotated[
    Annotated[TubeSection, Tag("tube")]
    | Annotated[RoundSection, Tag("round")]
    | Annotated[RectangleSection, Tag("rectangle")]
    | Annotated[GeneralSection, Tag("general")],
    Discriminator(_kind_of_section),
]
