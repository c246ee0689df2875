"""The keys of a turbulent flow: a random force per length, spread along a tube."""

from typing import Annotated, Literal

from pydantic import Field

from .quantities import (
    Band_Hz,
    By_kind,
    Direction,
    Frequency_Hz,
    Length_m,
    Number,
    Positive_factor,
    Range,
    Section,
    Unit,
    Vector,
)

Two_or_more = Field(min_length=2)
Velocity = Annotated[Number, Range("give the velocity of the flow in m/s", above=0, at_most=1000)]
Fluid_density = Annotated[Number, Range("in kg/m3? water has 1000", above=0, at_most=3e4)]
Line_psd = Annotated[Number, Range("a density of power is positive", above=0), Unit("N²/m²/Hz")]
Reduced = Annotated[Number, Range("give a positive number", above=0), Unit("1")]
Void_fraction = Annotated[
    Number, Range("a fraction, not per cent: 80 % is 0.8", above=0, below=1), Unit("1")
]
Tolerance = Annotated[
    Number, Range("a small fraction: 0.01 for one per cent", above=0, at_most=0.2), Unit("1")
]
VELOCITY = (
    "Velocity of the flow across the tube, as the source of the spectrum defines it (in a bundle"
    " usually that between the tubes)."
)
DENSITY = "Density of the fluid outside the tube."


class Ends(Section):
    """The two ends of a stretch of the tube."""

    from_m: Vector = Field(
        description="Position of one end of the stretch, within 5 mm of the centreline.",
        examples=[[0.0, 0.0, 0.8]],
    )
    to_m: Vector = Field(
        description="Position of the other end, within 5 mm of the centreline.",
        examples=[[0.0, 0.0, 1.6]],
    )


class Stretch(Ends):
    """A stretch of the tube that the flow acts on."""

    factor: Positive_factor = Field(
        1.0,
        description="Force per length on this stretch over that of the spectrum. If the flow has"
        " another speed it is density times velocity² over those of the spectrum.",
        examples=[0.25],
    )


class FlatSpectrum(Section):
    """A one-sided PSD that is flat in the band."""

    kind: Literal["flat"] = Field(description="This kind of spectrum.")


class TableSpectrum(Section):
    """A one-sided PSD of the force per length, given by points. Between them it is a straight line
    on two logarithmic axes.
    """

    kind: Literal["table"] = Field(description="This kind of spectrum.")
    frequency_Hz: Annotated[tuple[Frequency_Hz, ...], Two_or_more] = Field(
        description="Frequencies, ascending. They cover the band.", examples=[[5.0, 50.0, 200.0]]
    )
    psd_N2_per_m2_Hz: Annotated[tuple[Line_psd, ...], Two_or_more] = Field(
        description="PSD at each frequency, in (N/m)²/Hz.", examples=[[1.0e-2, 1.0e-3, 1.0e-5]]
    )


class TubeBundleSpectrum(Section):
    """The turbulence of a single-phase flow across a bundle of tubes, as steam generators are
    computed with it (code_aster, DEFI_SPEC_TURB).
    """

    kind: Literal["tube_bundle"] = Field(description="This kind of spectrum.")
    shape: Literal["two_slopes", "low_pass"] = Field(
        "two_slopes",
        description="Dimensionless PSD over the reduced frequency fr = f D / V. Two slopes:"
        " 5e-3 / fr^0.5 up to 0.2, 4e-5 / fr^3.5 above. Low pass: 1.5e-3 / (1 + (fr / 0.1)^2.7)."
        " Both are two-sided; the one-sided PSD is twice as large.",
    )
    velocity_m_per_s: Velocity = Field(description=VELOCITY, examples=[2.0])
    fluid_density_kg_per_m3: Fluid_density = Field(description=DENSITY, examples=[750.0])


class TwoPhaseSpectrum(Section):
    """The turbulence of a two-phase flow across a bundle of tubes, as steam generators are computed
    with it (code_aster, DEFI_SPEC_TURB). The force falls with the square of the frequency.
    """

    kind: Literal["two_phase"] = Field(description="This kind of spectrum.")
    void_fraction: Void_fraction = Field(
        description="Share of the volume that is steam.", examples=[0.8]
    )
    velocity_m_per_s: Velocity = Field(description=VELOCITY, examples=[3.0])
    fluid_density_kg_per_m3: Fluid_density = Field(
        description="Density of the mixture outside the tube.", examples=[180.0]
    )


class ReducedTableSpectrum(Section):
    """A dimensionless PSD over the reduced frequency f D / V, given by points. Between them it is a
    straight line on two logarithmic axes, so that power laws are exact.

    The one-sided PSD of the force per length is (density V² D / 2)² D / V times it, with the outer
    diameter D of the tube.
    """

    kind: Literal["reduced_table"] = Field(description="This kind of spectrum.")
    reduced_frequency: Annotated[tuple[Reduced, ...], Two_or_more] = Field(
        description="Reduced frequencies, ascending. They cover the band.",
        examples=[[0.01, 0.2, 3.0]],
    )
    reduced_psd: Annotated[tuple[Reduced, ...], Two_or_more] = Field(
        description="Dimensionless one-sided PSD at each of them.", examples=[[0.1, 0.02, 2.0e-6]]
    )
    velocity_m_per_s: Velocity = Field(description=VELOCITY, examples=[2.0])
    fluid_density_kg_per_m3: Fluid_density = Field(description=DENSITY, examples=[750.0])


LineForceSpectrum = Annotated[
    FlatSpectrum | TableSpectrum | TubeBundleSpectrum | TwoPhaseSpectrum | ReducedTableSpectrum,
    By_kind,
]


class TurbulentForce(Section):
    """The keys of turbulence that are not shared with other forces."""

    direction: Direction = Field(
        description="Direction of the force. Its length does not matter, and its part along the"
        " tube is left out.",
        examples=[[0.0, 1.0, 0.0]],
    )
    both_directions: bool = Field(
        False,
        description="Whether an independent force of the same level acts across `direction` too,"
        " perpendicular to it and to the tube.",
        examples=[True],
    )
    stretches: tuple[Stretch, ...] = Field(
        (), description="Stretches that the flow acts on; none for the whole tube."
    )
    correlation_length_m: Length_m = Field(
        description="Arc length over which the correlation of the force falls to 1/e.",
        examples=[0.065],
    )
    band_Hz: Band_Hz = Field(
        description="Band of the force; outside it is 0. Give at least 20"
        " integration.steps_per_second per period of its upper end.",
        examples=[[5.0, 200.0]],
    )
    spectrum: LineForceSpectrum = Field(
        description="How the power of the force is spread over the frequencies of the band."
    )
    tolerance: Tolerance = Field(
        0.01,
        description="Largest share of the variance of a mode's force that may be left out. It sets"
        " the number of independent forces. A mode above the band counts less, by (upper end of the"
        " band / its frequency)^4; a variance below 1e-4 of the largest counts as that.",
    )
