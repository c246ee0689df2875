"""The keys of a homogeneous two-phase mixture: its density, and the damping of the two phases.

The density is filled in when the configuration is read, so that the configuration as it runs holds
the number.
"""

from typing import Annotated

from pydantic import Field, ValidationInfo
from pydantic_core import PydanticCustomError

from .quantities import Ascending, Length, Number, Range, Section, Unit

Share = Annotated[
    Number, Range("a fraction, not per cent: 85 % is 0.85", at_least=0, at_most=1), Unit("1")
]
Phase_density = Annotated[
    Number, Range("in kg/m3? 1 g/cm3 is 1000", above=0, at_most=2e4), Unit("kg/m³")
]
ROUNDING = 1.0e-9  # relative, between a density given and that of the mixture


class TwoPhaseDamping(Section):
    """The damping of a two-phase flow round a tube of a bundle or in an annulus: the ratio

    coefficient (liquid density D² / m) (1 + (D/De)³) / (1 - (D/De)²)² h,

    h rising from 0 without vapour to 1 at the first of two void fractions, constant to the second,
    and falling to 0 without liquid. Its numbers belong to a source: there is no default.
    """

    coefficient: Annotated[
        Number, Range("a fraction: 4 % is 0.04", above=0, at_most=1), Unit("1")
    ] = Field(
        description="Damping ratio at h = 1, over the factors of mass and confinement.",
        examples=[0.04],
    )
    plateau: Annotated[
        tuple[Share, ...],
        Length("give two, where the damping stops rising and where it begins to fall", 2),
        Ascending("give the lower one first"),
    ] = Field(
        description="Void fractions between which the damping is largest.", examples=[[0.4, 0.7]]
    )

    def share(self, void_fraction: float) -> float:
        """Return h at a void fraction."""
        first, last = self.plateau
        rise = void_fraction / first if void_fraction < first else 1.0
        return (1.0 - void_fraction) / (1.0 - last) if void_fraction > last else rise


class Mixture(Section):
    """A homogeneous mixture of vapour and liquid, which move at one velocity."""

    void_fraction: Share = Field(description="Share of the volume that is vapour.", examples=[0.85])
    liquid_density_kg_per_m3: Phase_density = Field(
        description="Density of the liquid.", examples=[750.0]
    )
    vapour_density_kg_per_m3: Phase_density = Field(
        description="Density of the vapour.", examples=[33.2]
    )

    @property
    def density(self) -> float:
        """Return the density of the mixture in kg/m³."""
        void = self.void_fraction
        return void * self.vapour_density_kg_per_m3 + (1.0 - void) * self.liquid_density_kg_per_m3


def given_or_mixed(value: float | None, info: ValidationInfo) -> float | None:
    """Return a density given, or that of the `mixture` of the same section.

    Raises PydanticCustomError if both are given and differ.
    """
    mixture = info.data.get("mixture")
    if mixture is None:
        return value
    if value is not None and abs(value - mixture.density) > ROUNDING * mixture.density:
        raise PydanticCustomError(
            "mixture",
            "is not that of the mixture, {density} kg/m3: leave one of them out",
            {"density": f"{mixture.density:.6g}"},
        )
    return mixture.density
