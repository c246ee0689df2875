"""The declaration of the configuration: every key with its type, unit, range, default, meaning and
an example. The keys of the structure, the supports and the excitation are in the modules of those
names.

The checks, the JSON schema and the key reference all read this declaration.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field

from .excitation import Excitation
from .flow import Flow
from .initial import Initial
from .quantities import (
    Ascending,
    Axis,
    Band_Hz,
    Checked,
    Frequency_Hz,
    Length,
    Name,
    Not_empty,
    Number,
    One_or,
    Pattern,
    Position,
    Positive_factor,
    Range,
    Section,
    Stiffness,
    Unit,
    Whole,
)
from .reserved_names import is_reserved
from .structure import Damping, ModalDamping, Structure
from .supports import LocalElement, PointMass, Support
from .wear import Wear

Gap_m = Annotated[Number, Range("give the radial clearance in metres", above=0, at_most=10)]
Names = Annotated[tuple[Name, ...], Not_empty]
Stress_Pa = Annotated[Number, Range("in Pa? 240 MPa is 240.0e6", at_least=1e4, at_most=1e13)]
Force_N = Annotated[Number, Range("give the force in newtons RMS", above=0, at_most=1e6)]
Duration_s = Annotated[Number, Range("give the duration in seconds", above=0, at_most=1e5)]
Start_up_s = Annotated[
    Number, Range("give the duration in seconds, 0 for none", at_least=0, at_most=1e5)
]
Fraction_of_gap = Annotated[
    Number, Range("a small fraction of the gap: 1.0e-6", at_least=0, at_most=0.1), Unit("1")
]
Overlap = Annotated[
    Number, Range("a fraction, not per cent: 65 % is 0.65", at_least=0, at_most=0.95), Unit("1")
]
Stiffness_range = Annotated[
    tuple[Stiffness, ...],
    Length("give two, the lowest and the highest stiffness in N/m", 2),
    Ascending("give the lower end first"),
]

LONGEST_NAME = 100  # characters of a study's name; with the name of a case it names files


@dataclass(frozen=True)
class OwnFolder(Checked):
    """A name of a folder in results/ that no target of the workflow writes to."""

    def fault(self, value: str) -> str | None:
        """Return that a name is reserved, or too long."""
        if is_reserved(value):
            return f"is the folder of another target in results/: {self.remedy}"
        if len(value) > LONGEST_NAME:
            return f"has {len(value)} characters, at most {LONGEST_NAME}: {self.remedy}"
        return None

    def json_keywords(self) -> dict[str, Any]:
        """Return the greatest length."""
        return {"maxLength": LONGEST_NAME}


Study_name = Annotated[
    str,
    Pattern("a folder name of letters, digits, _ and -", "[A-Za-z0-9][A-Za-z0-9_-]*"),
    OwnFolder("give the study a short name of its own, as in my_tube"),
]


class Basis(Section):
    """The vectors that span the reduced model of a tube, or of matrices with more than 400 degrees
    of freedom. Smaller structures keep all their modes.
    """

    free_modes_to_Hz: Frequency_Hz = Field(
        7500.0, description="Modes of the structure without contact are kept up to this frequency."
    )
    constrained_modes_to_Hz: Frequency_Hz = Field(
        1000.0,
        description="Modes with all contact points held in both transverse directions, and all"
        " local elements held, are kept up to this frequency.",
    )
    attachment_shapes: bool = Field(
        True,
        description="Whether the static responses to a unit force at each contact point and local"
        " element are kept.",
    )


class Integration(Section):
    """The integration in time."""

    scheme: Literal["exact", "newmark"] = Field(
        "exact",
        description="Step of a mode: `exact` for a force that is linear over the step, or"
        " `newmark`, average acceleration (beta = 1/4, gamma = 1/2).",
    )
    steps_per_second: Annotated[
        Whole,
        Range(
            "20480 with the exact modal step; the paper's 2e-5 s is 50000 steps per second",
            at_least=100,
            at_most=10**8,
        ),
    ] = Field(
        20480,
        description="Integration steps per second: 5 times a whole multiple, 2 or more, of"
        " record.sampling_frequency_Hz, unless record.every_step is true.",
    )
    start_up_s: Start_up_s = Field(
        6.0, description="Duration that is simulated before the record and then discarded."
    )
    imperfection: Fraction_of_gap = Field(
        1.0e-6,
        description="Largest random offset of each obstacle's centre in each transverse direction,"
        " as a fraction of the gap of the case. Every seed draws its own. The offsets couple the"
        " two directions of motion of a perfectly symmetric structure.",
    )


class LogSpaced(Section):
    """Values evenly spaced in logarithm."""

    first: Annotated[Force_N, Unit("N")] = Field(description="Smallest value.", examples=[0.05])
    last: Annotated[Force_N, Unit("N")] = Field(description="Largest value.", examples=[20.0])
    count: Annotated[Whole, Range("the number of loads", at_least=1, at_most=10**4)] = Field(
        description="Number of values, both ends included.", examples=[24]
    )


class Grid(Section):
    """The cases of the study: every load with every gap and every seed."""

    load_rms_N: One_or[LogSpaced, Annotated[tuple[Force_N, ...], Not_empty]] = Field(
        description="Loads: the RMS of the force in N, or of the acceleration in m/s² for base"
        " motion. A list, or first, last and count of log-spaced values.",
        examples=[[0.5, 2.0, 5.0, 20.0]],
    )
    gap_m: Annotated[tuple[Gap_m, ...], Not_empty] = Field(
        description="Gaps: the radial clearance between the centred structure and its supports.",
        examples=[[2.8886e-4, 5.1106e-5]],
    )
    seeds: Annotated[
        Whole, Range("the number of seeds: 4 give a scatter", at_least=1, at_most=10**4)
    ] = Field(
        4, description="Number of independent realisations of the force. They are numbered from 0."
    )


class Sensors(Section):
    """The recorded quantities, at named points: displacement and acceleration."""

    points: Names = Field(description="Named points.", examples=[["apex", "bend_45"]])
    directions: Annotated[tuple[Axis, ...], Not_empty] = Field(
        ("x", "y"), description="Directions recorded at each point."
    )


class ShapeLine(Section):
    """Points of a tube whose displacement is recorded for the operational deflection shape: evenly
    spaced in arc length from end to end, the ends left out.
    """

    points: Annotated[
        Whole, Range("25 points or more draw the shape", at_least=3, at_most=2000)
    ] = Field(27, description="Number of points.")
    direction: Axis = Field(
        "y", description="Direction of the displacement, one of record.sensors.directions."
    )


class RecordKeys(Section):
    """The record of a case, and its sampling."""

    duration_s: Duration_s = Field(49.0, description="Duration of the record, after the start-up.")
    sampling_frequency_Hz: Frequency_Hz = Field(
        2048, description="Sampling frequency of the record."
    )
    sensors: Sensors | None = Field(
        None,
        description="Sensors. A tube needs them; for other structures, null records every"
        " direction of every named point.",
    )
    shape_line: ShapeLine = Field(ShapeLine(), description="Points of the deflection shape.")
    stress_limit_Pa: Stress_Pa = Field(
        240.0e6,
        description="Bending stress of the outer fibre above which a case is flagged. It changes"
        " no result.",
    )
    keep_time_series: bool = Field(
        False,
        description="Whether time series are written to files. Spectra and statistics always are.",
    )
    every_step: bool = Field(
        False,
        description="True records displacement and force of contacts and local elements at each"
        " integration step, unfiltered, in place of everything else. For short runs, with"
        " integration.start_up_s = 0.",
    )


class Spectra(Section):
    """Spectra by Welch's method. No trend is removed."""

    segment_s: Duration_s = Field(10.0, description="Length of a segment.")
    overlap: Overlap = Field(
        0.65, description="Overlap of neighbouring segments, as a fraction of a segment."
    )
    window: Literal["hann", "boxcar"] = Field("hann", description="Window of each segment.")


class Lscf(Section):
    """The least-squares complex frequency-domain method (LSCF) on output spectra."""

    band_Hz: Band_Hz = Field((8.0, 60.0), description="Band that the model is fitted in.")
    max_order: Annotated[
        Whole, Range("24 is enough for a band with a handful of modes", at_least=2, at_most=200)
    ] = Field(
        24,
        description="Highest order of the polynomial, which the stabilisation diagram goes up to.",
    )
    references: Names = Field(
        description="Reference points of the cross-spectra, all of them recorded.",
        examples=[["apex", "bend_45"]],
    )


class Broadband(Section):
    """The comparison of measured and computed spectra over a band."""

    point: Name = Field(description="Recorded point whose spectrum is used.", examples=["bend_45"])
    band_Hz: Band_Hz = Field(
        (6.0, 99.0), description="Band of the comparison, inside the excited band."
    )


class Identification(Section):
    """The search of the methods for the equivalent support of a tube under a broadband force."""

    response_point: Name = Field(
        description="Recorded point whose PSD shows the main peak.", examples=["apex"]
    )
    peak_search_Hz: Band_Hz = Field(
        (8.0, 45.0), description="Band in which the main peak is searched."
    )
    lscf: Lscf = Field(description="The pole by LSCF.")
    broadband: Broadband = Field(description="The comparison of whole spectra.")
    stiffness_range_N_per_m: Stiffness_range = Field(
        (1.0e3, 1.0e8),
        description="Range of the equivalent stiffness that is searched. An estimate outside it is"
        " reported as unresolved.",
    )
    groups: One_or[Literal["all", "each"], tuple[Names, ...]] = Field(
        "all",
        description="Supports that share one equivalent stiffness and damping in each direction:"
        " `all`, `each` for itself, or a list of groups, each a list of names of supports. A"
        " support in no group is one of its own.",
        examples=[[["plate_1", "plate_2"], ["bar"]]],
    )


class Overlay(Section):
    """The campaign that figure 5 draws over the simulation: a measured one, or a synthetic one made
    from the study itself with another force, another gap and measuring noise.
    """

    campaign: str | None = Field(
        None,
        description="Path of a measured campaign from the folder of the run; null for"
        " a synthetic one.",
        examples=["campaigns/mine.nc"],
    )
    load_rms_N: Annotated[tuple[Force_N, ...], Not_empty] = Field(
        (0.5, 2.0, 5.0, 20.0),
        description="Loads to draw. For each, the nearest load of the grid is taken.",
    )
    gap_ratio: Positive_factor = Field(
        1.05, description="Gap of the synthetic campaign over the largest gap of the grid."
    )
    noise: Annotated[
        Number,
        Range("a fraction of the channel's RMS: 1 % is 0.01", at_least=0, at_most=1),
        Unit("1"),
    ] = Field(
        0.01,
        description="RMS of the measuring noise of the synthetic campaign, as a fraction of the"
        " largest channel RMS at the lowest load.",
    )
    seed: Annotated[
        Whole,
        Range("a seed that no case of the study has, such as 1000", at_least=0, at_most=10**6),
    ] = Field(
        1000,
        description="Seed of the force of the synthetic campaign. It must not be one of the"
        " study's, 0 to grid.seeds - 1.",
    )


class Config(Section):
    """A whole study."""

    study: Study_name = Field(
        description="Name of the study. Results go to the folder of this name in results.",
        examples=["my_tube"],
    )
    seed: Annotated[Whole, Range("any whole number", at_least=0, at_most=2**63)] = Field(
        2012, description="Entropy of every random stream of the study."
    )
    structure: Structure = Field(description="The structure without contact.")
    damping: Damping = Field(
        ModalDamping(kind="modal", first_ratios=(0.015, 0.015), other_ratio=0.002),
        description="Damping of the structure without contact.",
    )
    supports: tuple[Support, ...] = Field((), description="Supports with a gap.")
    elements: tuple[LocalElement, ...] = Field(
        (), description="Force laws between a point and the ground, or between two points."
    )
    masses: tuple[PointMass, ...] = Field((), description="Masses added to the structure.")
    mode_frequency_factors: tuple[Positive_factor, ...] = Field(
        (),
        description="Corrections of the first modes of the structure without contact, in the order"
        " of their computed frequencies: measured over computed frequency.",
        examples=[[1.02, 0.99]],
    )
    initial: Initial | None = Field(None, description="State at the start of a run; null for rest.")
    points: dict[Name, Position] = Field(
        {},
        description="Names for positions on a tube, each within 5 mm of the centreline. Other"
        " structures bring their own points: of these, the positions, which a comparison with"
        " measurements needs.",
        examples=[{"apex": [0.0, 0.0, 1.0]}],
    )
    excitation: Excitation = Field(description="The force.")
    basis: Basis = Field(Basis(), description="The reduced model.")
    integration: Integration = Field(Integration(), description="The integration in time.")
    grid: Grid = Field(description="Loads, gaps and seeds.")
    record: RecordKeys = Field(description="The record of a case.")
    spectra: Spectra = Field(Spectra(), description="Spectral estimation.")
    identification: Identification | None = Field(
        None,
        description="Identification of the equivalent support; null for a study that ends with its"
        " statistics.",
    )
    overlay: Overlay = Field(Overlay(), description="The campaign of figure 5.")
    flow: Flow | None = Field(
        None,
        description="A flow across the tube, for `vibroimpact stability` and fluid-elastic forces;"
        " null for none.",
    )
    wear: Wear | None = Field(
        None, description="Wear life on the study's page and in its wear.csv; null for none."
    )
