"""The keys of a flow across a tube, for its fluid-elastic stability."""

from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from .mixture import Mixture, given_or_mixed
from .quantities import (
    NOT_GIVEN,
    Band_Hz,
    By_kind,
    Direction,
    Frequency_Hz,
    Length_m,
    Not_empty,
    Number,
    Positive_factor,
    Range,
    Section,
    Unit,
)
from .turbulence import Ends, Fluid_density, Velocity

Constant = Annotated[
    Number, Range("Connors' constant is about 2.4 to 10", above=0, at_most=100), Unit("1")
]
MIXTURE = "Vapour and liquid, whose density is the homogeneous one; null for a density"
Coefficient = Annotated[
    Number, Range("a coefficient of the force", at_least=-1e4, at_most=1e4), Unit("1")
]
Positive_number = Annotated[
    Number, Range("give a positive number", above=0, at_most=1e4), Unit("1")
]


class FlowStretch(Ends):
    """A stretch of the tube with a flow of its own."""

    velocity_factor: Positive_factor = Field(
        1.0,
        description="Velocity there over flow.velocity_m_per_s. A profile is cut into stretches.",
        examples=[0.5],
    )
    mixture: Mixture | None = Field(None, description=f"{MIXTURE} of the flow there.")
    density_kg_per_m3: Fluid_density | None = Field(
        None,
        validate_default=True,
        description="Density of the fluid outside there; null for that of the mixture, or for"
        " flow.density_kg_per_m3.",
        examples=[145.7],
    )

    _density = field_validator("density_kg_per_m3")(given_or_mixed)


class Connors(Section):
    """Connors' criterion: V_c = K f sqrt(m 2 pi zeta / density)."""

    kind: Literal["connors"] = Field(description="This kind of criterion.")
    constant: Annotated[tuple[Constant, ...], Not_empty] = Field(
        description="K, or several for a range. It belongs to the pattern of the bundle and to the"
        " definition of damping of its source, so that there is no default.",
        examples=[[2.4, 4.0]],
    )


class Tema(Section):
    """The criterion of TEMA: V_c = D_T f D, with a factor D_T of pattern, pitch, mass and damping.

    The factors are second-hand: compare them with the standard before a design rests on them.
    """

    kind: Literal["tema"] = Field(description="This kind of criterion.")
    pattern_deg: Literal[30, 45, 60, 90] = Field(
        description="Angle of the pattern: 30 and 60 triangular, 45 and 90 square.", examples=[90]
    )
    pitch_m: Length_m = Field(
        description="Distance of the axes of neighbouring tubes.", examples=[0.0325]
    )


class Lags(Section):
    """A fluid-elastic force with memory, of one tube in a rigid bundle:

    F = -density V²/2 (a0 u + a1 (D/V) u' + sum b_j z_j),  z_j' = -gamma_j (V/D) z_j + u'.

    The quasi-steady force with a lag has a0 = -dC_L/d(y/D), a1 = C_D, b = [dC_L/d(y/D)] and
    gamma = [1/mu], with the delay mu D/V: kind quasi_steady.
    """

    kind: Literal["lags"] = Field(description="This kind of coupling.")
    stiffness: Coefficient = Field(description="a0.", examples=[20.0])
    damping: Coefficient = Field(description="a1.", examples=[0.3])
    amplitudes: tuple[Coefficient, ...] = Field(
        (), description="b, one for each lag.", examples=[[-20.0]]
    )
    rates: tuple[Positive_number, ...] = Field(
        (), description="gamma, one for each lag.", examples=[[1.0]]
    )

    reduced_velocity: tuple[Positive_number, Positive_number] | None = Field(
        None,
        description="Reduced velocities V/(f D) that the coefficients were fitted between, for a"
        " warning outside; null for no limit.",
        examples=[[2.0, 50.0]],
    )


class QuasiSteady(Section):
    """The quasi-steady force of one tube in a rigid bundle, its lift late by a first-order lag:
    kind lags with stiffness -lift_slope, damping drag, amplitudes [lift_slope], rates [1/delay].
    """

    kind: Literal["quasi_steady"] = Field(description="This kind of coupling.")
    lift_slope: Coefficient = Field(
        description="Slope of the lift coefficient over y/D.", examples=[-20.0]
    )
    drag: Coefficient = Field(description="Drag coefficient.", examples=[0.3])
    delay: Positive_number = Field(1.0, description="Delay of the lift over D/V, mu.")


class ConnorsForce(Section):
    """The damping of Connors' law at every frequency of a band, C_d = -4 V/(f D K²): lags whose
    critical velocities are Connors'. Its stiffness is 0 in the middle of the band and drifts.
    """

    kind: Literal["connors"] = Field(description="This kind of coupling.")
    constant: Constant = Field(description="Connors' K.", examples=[3.0])
    band_Hz: Band_Hz = Field(
        description="Band of the modes that matter. Wider than a decade the stiffness drifts more.",
        examples=[[5.0, 200.0]],
    )


class NegativeDamping(Section):
    """The damping of Connors' law frozen at one frequency: a negative damper along the tube. It has
    Connors' critical velocity for a mode of that frequency, and no memory.
    """

    kind: Literal["negative_damping"] = Field(description="This kind of coupling.")
    constant: Constant = Field(description="Connors' K.", examples=[3.0])
    frequency_Hz: Frequency_Hz = Field(
        description="Frequency of the mode that it is frozen at.", examples=[30.0]
    )


Coupling = Annotated[Lags | QuasiSteady | ConnorsForce | NegativeDamping, By_kind]


class DimensionlessTurbulence(Section):
    """Turbulence with the dimensionless spectrum of `excitation`: at each velocity its frequencies
    and its level are those of that velocity. A load of the grid is that at the velocity of
    excitation.spectrum.
    """

    kind: Literal["dimensionless"] = Field(description="This kind of turbulence.")


class PowerTurbulence(Section):
    """A force whose RMS rises with a power of the velocity, and whose spectrum stays the same."""

    kind: Literal["power"] = Field(description="This kind of turbulence.")
    exponent: Annotated[
        Number, Range("2 for a force like the dynamic pressure", at_least=0, at_most=10), Unit("1")
    ] = Field(description="Exponent of the velocity.", examples=[2.0])
    at_m_per_s: Velocity = Field(
        description="Velocity at which the force has the load of the grid.", examples=[2.0]
    )


class Flow(Section):
    """A flow across the tube, for `vibroimpact stability` and, with acting_m_per_s, for the
    simulation.
    """

    velocity_m_per_s: Annotated[tuple[Velocity, ...], Not_empty] = Field(
        description="Velocities between the tubes: of an upstream velocity times P / (P - D).",
        examples=[[1.0, 2.0, 3.0]],
    )
    mixture: Mixture | None = Field(None, description=f"{MIXTURE}.")
    density_kg_per_m3: Fluid_density | None = Field(
        None,
        validate_default=True,
        description="Density of the fluid outside; null for that of the mixture.",
        examples=[998.0],
    )
    direction: Direction = Field(
        description="Direction of the fluid-elastic force, across the flow. Its part along the tube"
        " is left out.",
        examples=[[0.0, 1.0, 0.0]],
    )
    both_directions: bool = Field(
        False,
        description="Whether the direction across it and the tube is computed too.",
        examples=[True],
    )
    stretches: tuple[FlowStretch, ...] = Field(
        (), description="Stretches that the flow acts on; none for the whole tube."
    )
    criterion: Annotated[Connors | Tema, By_kind] = Field(
        description="The criterion of the critical velocity of a mode."
    )
    coupling: Coupling | None = Field(
        None, description="Fluid-elastic force, for eigenvalues against velocity; null for none."
    )
    turbulence: Annotated[DimensionlessTurbulence | PowerTurbulence, By_kind] | None = Field(
        None,
        description="How the force of `excitation` follows the velocity in `vibroimpact stability"
        " --simulate`; null: it is the same at each.",
    )
    acting_m_per_s: Velocity | None = Field(
        None,
        description="Velocity at which the fluid-elastic force of `coupling` acts in the"
        " simulation; null: it acts in none.",
        examples=[1.5],
    )

    @field_validator("density_kg_per_m3")
    @classmethod
    def _density(cls, value: float | None, info: ValidationInfo) -> float | None:
        """Return the density given, or that of the mixture."""
        value = given_or_mixed(value, info)
        if value is None and "mixture" in info.data:
            raise PydanticCustomError(NOT_GIVEN, "is missing: give it, or a mixture")
        return value
