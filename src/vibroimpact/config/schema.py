"""The only declaration of the configuration's keys, units, ranges and defaults (the structure's are
in config_structure).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .excitation import Excitation
from .quantities import (
    Axis,
    Band_Hz,
    Duration_s,
    Force_N,
    Fraction_of_gap,
    Frequency_Hz,
    Gap_m,
    Name,
    Number,
    Overlap,
    Positive_factor,
    Section,
    Start_up_s,
    Stiffness_range,
    Stress_Pa,
    Study_name,
    Vector,
    count,
    one_or_list,
    within,
)
from .structure import Damping, ModalDamping, Structure
from .supports import Initial, LocalElement, PointMass, Support

F16_DATA = "../shared/data/f16_ground_vibration"
SILVERBOX_DATA = "../shared/data/silverbox"


class Basis(Section):
    """What spans the reduced model."""

    free_modes_to_Hz: Frequency_Hz = 7500.0
    constrained_modes_to_Hz: Frequency_Hz = 1000.0
    attachment_shapes: bool = True


class Integration(Section):
    """Scheme and step, start-up before the record, and the seeded initial offset as a fraction of
    the gap.
    """

    scheme: Literal["exact", "newmark"] = "exact"
    steps_per_second: count(
        100, 10**8, "20480 with the exact modal step; the paper's 2e-5 s is 50000 steps per second"
    ) = 20480
    start_up_s: Start_up_s = 6.0
    imperfection: Fraction_of_gap = 1.0e-6


class LogSpaced(Section):
    """`count` values from `first` to `last`, evenly spaced in logarithm."""

    first: Force_N
    last: Force_N
    count: count(1, 10**4, "the number of loads")


class Grid(Section):
    """The cases of the study: every load with every gap and every seed."""

    load_rms_N: one_or_list(LogSpaced, Annotated[tuple[Force_N, ...], Field(min_length=1)])
    gap_m: Annotated[tuple[Gap_m, ...], Field(min_length=1)]
    seeds: count(1, 10**4, "the number of seeds: 4 give a scatter") = 4


class Sensors(Section):
    """Named points and directions whose displacement and acceleration are kept."""

    points: Annotated[tuple[Name, ...], Field(min_length=1)]
    directions: Annotated[tuple[Axis, ...], Field(min_length=1)] = ("x", "y")


class ShapeLine(Section):
    """Points evenly spaced in arc length from end to end (ends excluded), for the deflection
    shape.
    """

    points: count(3, 2000, "25 points or more draw the shape") = 27
    direction: Axis = "y"


class RecordKeys(Section):
    """What a case keeps, and how it is sampled; every_step: contacts and elements at each step,
    unfiltered, in place of all else.
    """

    duration_s: Duration_s = 49.0
    sampling_frequency_Hz: Frequency_Hz = 2048
    sensors: Sensors | None = None
    shape_line: ShapeLine = ShapeLine()
    stress_limit_Pa: Stress_Pa = 240.0e6
    keep_time_series: bool = False
    every_step: bool = False


class Spectra(Section):
    """Welch's averages: buffer, overlap, window."""

    segment_s: Duration_s = 10.0
    overlap: Overlap = 0.65
    window: Literal["hann", "boxcar"] = "hann"


class Lscf(Section):
    """Band, highest polynomial order and reference points of the output-only LSCF."""

    band_Hz: Band_Hz = (8.0, 60.0)
    max_order: count(2, 200, "24 is enough for a band with a handful of modes") = 24
    references: Annotated[tuple[Name, ...], Field(min_length=1)]


class Broadband(Section):
    """Response point and band of the correlation of spectra."""

    point: Name
    band_Hz: Band_Hz = (6.0, 99.0)


class Identification(Section):
    """Where the three identifications look."""

    response_point: Name
    peak_search_Hz: Band_Hz = (8.0, 45.0)
    lscf: Lscf
    broadband: Broadband
    stiffness_range_N_per_m: Stiffness_range = (1.0e3, 1.0e8)


class Overlay(Section):
    """The campaign laid over the simulation in figure 5: a measured file, or a synthetic one made
    with these loads, gap and noise.
    """

    campaign: str | None = None
    load_rms_N: Annotated[tuple[Force_N, ...], Field(min_length=1)] = (0.5, 2.0, 5.0, 20.0)
    gap_ratio: Positive_factor = 1.05
    noise: Annotated[
        Number, within("a fraction of the channel's RMS: 1 % is 0.01", at_least=0, at_most=1)
    ] = 0.01
    seed: count(0, 10**6, "a seed that no case of the study has, such as 1000") = 1000


class Config(Section):
    """A whole study. Results go to results/<study>/; seed is the entropy of every random stream."""

    study: Study_name
    seed: count(0, 2**63, "any whole number") = 2012
    structure: Structure
    damping: Damping = ModalDamping(kind="modal", first_ratios=(0.015, 0.015), other_ratio=0.002)
    supports: tuple[Support, ...] = ()
    elements: tuple[LocalElement, ...] = ()
    masses: tuple[PointMass, ...] = ()
    mode_frequency_factors: tuple[Positive_factor, ...] = ()
    initial: Initial | None = None
    points: dict[Name, Vector] = {}
    excitation: Excitation
    basis: Basis = Basis()
    integration: Integration = Integration()
    grid: Grid
    record: RecordKeys
    spectra: Spectra = Spectra()
    identification: Identification | None = None
    overlay: Overlay = Overlay()
    f16_data: str = F16_DATA
    silverbox_data: str = SILVERBOX_DATA
