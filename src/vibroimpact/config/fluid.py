"""The keys of the still fluids inside and outside a tube.

Density and viscosity of a named fluid are filled in when the configuration is read, so that the
configuration as it runs holds the numbers.
"""

from functools import partial
from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from .material import given_or_named, named_or_given, named_temperature
from .materials.fluids import fluid_properties
from .mixture import Mixture, TwoPhaseDamping, given_or_mixed
from .quantities import (
    By_kind,
    Diameter_m,
    Number,
    One_or,
    Position,
    Range,
    Section,
    Temperature_C,
    Two_axes,
    Unit,
)

Fluid_density = Annotated[
    Number, Range("in kg/m3? 1 g/cm3 is 1000", at_least=0, at_most=2e4), Unit("kg/m³")
]
Viscosity = Annotated[
    Number, Range("in Pa s? 1 mPa s is 1.0e-3, 0 for no damping", at_least=0, at_most=100)
]

Fluid_name = Literal["water", "steam"]
OR_NAMED = "Null for that of the named fluid."
MIXTURE = "Vapour and liquid in place of one fluid; null for one."
NAME = "Name of a fluid at saturation; null for numbers."
TEMPERATURE = "Temperature of the named fluid; null for 20 °C."
FROM = (
    "Position of the start of the fluid; null for the start of the tube. The stretch may"
    " be given from either end."
)
TO = "Position of the end of the fluid; null for the end of the tube."
UNDAMPED = (
    "has no effect with an added mass coefficient: give an equivalent diameter (annulus) for"
    " damping"
)
Coefficient_of_mass = Annotated[
    Number, Range("1 for a circle in much fluid, more when confined", at_least=0), Unit("1")
]


class Unconfined(Section):
    """Much fluid all round: an added mass coefficient of 1 for a circle."""

    kind: Literal["unconfined"] = Field(description="This kind of confinement.")


class Bundle(Section):
    """A tube among the tubes of a bundle that do not move."""

    kind: Literal["bundle"] = Field(description="This kind of confinement.")
    pitch_m: Diameter_m = Field(
        description="Distance between the axes of neighbouring tubes.", examples=[0.0320]
    )
    pattern: Literal["triangular", "square"] = Field(
        "triangular", description="Pattern of the bundle."
    )


class Annulus(Section):
    """A tube in a round channel, or in a confinement of the same effect."""

    kind: Literal["annulus"] = Field(description="This kind of confinement.")
    equivalent_diameter_m: Diameter_m = Field(
        description="Inner diameter of the channel, above the diameter of the tube.",
        examples=[0.040],
    )


class AddedMassCoefficient(Section):
    """An added mass that is known, for any cross-section. It brings no damping."""

    kind: Literal["coefficient"] = Field(description="This kind of confinement.")
    added_mass_coefficient: One_or[
        Coefficient_of_mass, Annotated[tuple[Coefficient_of_mass, ...], Two_axes]
    ] = Field(
        description="Added mass over the mass of the fluid that the outline displaces: one value,"
        " or a list for motion along the first and the second axis of the section.",
        examples=[1.5],
    )


class FluidInside(Section):
    """A fluid that fills the tube and moves with it in all directions."""

    model_config = named_or_given("density_kg_per_m3", instead="mixture")
    kind: Literal["inside"] = Field(description="This kind of fluid.")
    name: Fluid_name | None = Field(None, description=NAME, examples=["water"])
    temperature_C: Temperature_C | None = Field(None, description=TEMPERATURE, examples=[20.0])
    mixture: Mixture | None = Field(None, description=MIXTURE)
    density_kg_per_m3: Fluid_density | None = Field(
        None, description=f"Density. {OR_NAMED[:-1]}, or of the mixture.", examples=[998.2]
    )
    from_m: Position | None = Field(None, description=FROM, examples=[[-0.3, 0.0, 0.0]])
    to_m: Position | None = Field(None, description=TO, examples=[[-0.3, 0.0, 0.5]])

    _temperature = field_validator("temperature_C")(
        partial(named_temperature, properties=fluid_properties)
    )

    @field_validator("density_kg_per_m3")
    @classmethod
    def _density(cls, value: float | None, info: ValidationInfo) -> float | None:
        """Return the density given, of the mixture, or of the named fluid."""
        if "mixture" not in info.data:
            return value  # it is a problem of its own
        return given_or_named(given_or_mixed(value, info), info, fluid_properties)


class FluidOutside(FluidInside):
    """A still fluid round the tube. It adds mass to motion across the tube, and damps each mode by
    its viscosity as at the frequency of that mode without contact. Under base motion it moves with
    the obstacles.
    """

    kind: Literal["outside"] = Field(  # type: ignore[assignment]
        description="This kind of fluid."
    )
    confinement: Annotated[Unconfined | Bundle | Annulus | AddedMassCoefficient, By_kind] = Field(
        Unconfined(kind="unconfined"), description="The confinement of the fluid."
    )
    viscosity_Pa_s: Viscosity | None = Field(
        None, description=f"Dynamic viscosity, 0 for no damping. {OR_NAMED}", examples=[1.0e-3]
    )
    two_phase_damping: TwoPhaseDamping | None = Field(
        None, description="Damping by the two phases of the mixture; null for none."
    )

    @field_validator("two_phase_damping")
    @classmethod
    def _two_phase(
        cls, value: TwoPhaseDamping | None, info: ValidationInfo
    ) -> TwoPhaseDamping | None:
        """Return the damping, of a mixture in a confinement with a diameter."""
        if value is not None and info.data.get("mixture", True) is None:
            raise PydanticCustomError("unused", "has no effect without mixture: give one")
        if value is not None and getattr(info.data.get("confinement"), "kind", "") == "coefficient":
            raise PydanticCustomError("unused", UNDAMPED)
        return value

    @field_validator("viscosity_Pa_s")
    @classmethod
    def _viscosity(cls, value: float | None, info: ValidationInfo) -> float | None:
        """Return the viscosity given, or that of the named fluid; 0 if nothing uses it."""
        if getattr(info.data.get("confinement"), "kind", None) == "coefficient":
            if value:
                raise PydanticCustomError("unused", UNDAMPED)
            return 0.0
        return given_or_named(value, info, fluid_properties)


Fluids = tuple[Annotated[FluidInside | FluidOutside, By_kind], ...]
