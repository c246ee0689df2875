"""The keys of the wear life of a study."""

from typing import Annotated

from pydantic import Field

from .quantities import Number, Range, Section, Unit

Coefficient_m2_per_N = Annotated[
    Number, Range("a coefficient of wear is about 1e-16 to 1e-13 m²/N", above=0, below=1e-6)
]
Years = Annotated[Number, Range("give the time in years", above=0, at_most=1e4), Unit("years")]
Share = Annotated[Number, Range("give a share", above=0, at_most=1), Unit("1")]


class Wear(Section):
    """The wear life of the tube at its supports, for the study's page and `vibroimpact wear`. It
    changes no simulation.
    """

    coefficient_m2_per_N: tuple[Coefficient_m2_per_N, ...] = Field(
        (),
        description="Coefficients of wear of your pair of materials in your water, at least two for"
        " a range; none for the published ones of the support's shape, over all alloys.",
        examples=[[1.0e-15, 2.0e-14]],
    )
    slowing: bool = Field(
        False, description="Whether the slowing law EDF_MZ is added.", examples=[True]
    )
    years: Years = Field(40.0, description="Time in service.")
    duty: Share = Field(
        1.0, description="Share of the time in service under the load.", examples=[0.9]
    )
    wall_limit: Share = Field(0.4, description="Share of the wall at which a tube is plugged.")
    tilt_deg: Annotated[Number, Range("give a small angle", at_least=0, at_most=45)] = Field(
        0.0, description="Tilt of flat lands and bars on the tube's axis.", examples=[1.0]
    )
    tube_share: Share = Field(
        1.0,
        description="Share of the worn volume that is the tube's; the rest is the support's.",
        examples=[0.5],
    )
    gap_grows: bool = Field(
        False,
        description="Whether the gap grows by the depth: the work rate is then that of the study's"
        " own gaps, interpolated, and held beyond the largest.",
        examples=[True],
    )
