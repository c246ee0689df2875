"""The keys of the forces: their places and their course in time."""

from typing import Annotated, Literal

from pydantic import Field

from .quantities import (
    Band_Hz,
    By_kind,
    Direction,
    Frequency_Hz,
    Name,
    Number,
    Phase_deg,
    Section,
    Unit,
    Vector,
)
from .turbulence import TurbulentForce

Factor = Annotated[Number, Unit("1")]
DIRECTION = "Direction of the force. Its length does not matter."


class ForcePoint(Section):
    """One more point that the force of the case acts at."""

    point: Name = Field(description="Named point.", examples=["apex"])
    direction: Direction = Field(description=DIRECTION, examples=[[0.0, 1.0, 0.0]])
    factor: Factor = Field(
        1.0, description="Force at this point over the force of the case.", examples=[0.5]
    )


class Distributed(Section):
    """A stretch of the tube that the force of the case is spread over."""

    from_m: Vector = Field(
        description="Position of one end of the stretch, within 5 mm of the centreline.",
        examples=[[-0.30, 0.0, 0.50]],
    )
    to_m: Vector = Field(
        description="Position of the other end, within 5 mm of the centreline.",
        examples=[[-0.30, 0.0, 0.60]],
    )
    direction: Direction = Field(description=DIRECTION, examples=[[0.0, 1.0, 0.0]])
    factor_per_m: Number = Field(
        description="Force per metre over the force of the case.", examples=[10.0]
    )


class DeadLoad(Section):
    """A constant force at a point."""

    point: Name = Field(description="Named point.", examples=["apex"])
    direction: Direction = Field(description=DIRECTION, examples=[[0.0, 0.0, -1.0]])
    force_N: Number = Field(
        description="Force along the direction, the same in all cases.", examples=[2.0]
    )


CONSTANT = "Constant forces, the same in all cases."


class Forces(Section):
    """The places of the force of a case: a point, and those in `also` and `distributed`."""

    point: Name = Field(description="Named point that the force acts at.", examples=["shaker"])
    direction: Direction = Field(description=DIRECTION, examples=[[0.0, 1.0, 0.0]])
    turn_deg: Phase_deg = Field(
        0.0,
        description="Angle by which the force at the point is turned away from `direction`,"
        " right-handed about the axis `turn_about`.",
        examples=[2.0],
    )
    turn_about: Literal["z", "tube"] = Field(
        "z",
        description="Axis of turn_deg: the global z axis, or the tangent of the tube at the point.",
    )
    factor: Factor = Field(1.0, description="Force at the point over the force of the case.")
    also: tuple[ForcePoint, ...] = Field((), description="More points that the same force acts at.")
    distributed: tuple[Distributed, ...] = Field(
        (), description="Stretches of a tube that the same force is spread over."
    )
    constant: tuple[DeadLoad, ...] = Field((), description=CONSTANT)


BAND = (
    "Band in which the one-sided PSD is flat; outside it is 0. Give at least 20"
    " integration.steps_per_second per period of its upper end."
)
HARMONIC = "Frequency of the sine."
PHASE = (
    "Phase of the sine, sqrt(2) load sin(2 pi f t + phase). t = 0 at the start of the record; if"
    " record.every_step is true, at the start of the run."
)


class BandLimited(Forces):
    """A Gaussian force with a flat one-sided PSD in a band. It is scaled so that its RMS over the
    record is exactly the load of the case.
    """

    kind: Literal["band_limited"] = Field(description="This kind of excitation.")
    band_Hz: Band_Hz = Field(description=BAND, examples=[[5.0, 200.0]])


class Measured(Forces):
    """A measured force. It is resampled to the integration step and scaled so that its RMS over the
    record is exactly the load of the case. It must last for start-up and record.
    """

    kind: Literal["measured"] = Field(description="This kind of excitation.")
    file: str = Field(
        description="File of the force: netCDF (.nc), CSV with a header line (.csv) or MATLAB v5"
        " (.mat), from the folder in which the study is run.",
        examples=["measurements/force.csv"],
    )
    variable: str = Field(description="Name of the variable or column.", examples=["force"])
    sampling_frequency_Hz: Frequency_Hz | None = Field(
        None,
        description="Sampling frequency. Needed only if the file does not give it, by an"
        " attribute, a variable Fs or a time column, whose unit counts: `time [ms]`.",
        examples=[2048.0],
    )


class Harmonic(Forces):
    """A sine whose RMS is the load of the case."""

    kind: Literal["harmonic"] = Field(description="This kind of excitation.")
    frequency_Hz: Frequency_Hz = Field(description=HARMONIC, examples=[20.0])
    phase_deg: Phase_deg = Field(0.0, description=PHASE, examples=[90.0])


class WhiteNoise(Forces):
    """White noise: an independent Gaussian value at every integration step, whose standard
    deviation is the load of the case. The one-sided PSD is 2 load² / integration.steps_per_second,
    in N²/Hz, so that for a given PSD the load grows with the square root of the steps per second.
    The RMS of one record is the load on average only: records are not scaled to it.
    """

    kind: Literal["white_noise"] = Field(description="This kind of excitation.")


class Still(Section):
    """No force that varies: free motion from the initial state, under constant forces if there are
    any. The load of a case has no effect.
    """

    kind: Literal["none"] = Field(description="This kind of excitation.")
    constant: tuple[DeadLoad, ...] = Field((), description=CONSTANT)


class BandSignal(Section):
    """A Gaussian signal with a flat one-sided PSD in a band."""

    kind: Literal["band_limited"] = Field(description="This kind of signal.")
    band_Hz: Band_Hz = Field(description=BAND, examples=[[5.0, 200.0]])


class HarmonicSignal(Section):
    """A sine."""

    kind: Literal["harmonic"] = Field(description="This kind of signal.")
    frequency_Hz: Frequency_Hz = Field(description=HARMONIC, examples=[20.0])
    phase_deg: Phase_deg = Field(0.0, description=PHASE)


class BaseMotion(Section):
    """An acceleration of all that holds the structure. The load of a case is its RMS in m/s².
    Displacements of sensors are relative to the base.
    """

    kind: Literal["base_motion"] = Field(description="This kind of excitation.")
    direction: Direction = Field(
        description="Direction of the acceleration. Its length does not matter.",
        examples=[[1.0, 0.0, 0.0]],
    )
    obstacles: Literal["moving", "fixed"] = Field(
        "moving",
        description="Whether the obstacles of the supports move with the base or are fixed in"
        " space. Displacements of contacts with fixed obstacles are absolute.",
    )
    signal: Annotated[BandSignal | HarmonicSignal, By_kind] = Field(
        description="How the acceleration varies in time."
    )
    constant: tuple[DeadLoad, ...] = Field((), description=CONSTANT)


class Turbulence(TurbulentForce):
    """A Gaussian force per length along a tube, correlated over an arc length, as a turbulent flow
    exerts it.

    The load of a case is the RMS of the force in one direction, summed along the tube:
    sqrt(integral of the PSD times the double integral of exp(-|s - s'| / correlation length)).
    It scales the whole field. It is that RMS on average: records are not scaled to it. The command
    `check` prints the load that a spectrum with a velocity or a table amounts to.
    """

    kind: Literal["turbulence"] = Field(description="This kind of excitation.")
    constant: tuple[DeadLoad, ...] = Field((), description=CONSTANT)


Excitation = Annotated[
    BandLimited | Measured | Harmonic | WhiteNoise | Turbulence | Still | BaseMotion, By_kind
]


def highest_frequency(excitation: Excitation) -> float:
    """Return the highest excited frequency in Hz, 0 if none is stated."""
    source = excitation.signal if excitation.kind == "base_motion" else excitation
    if source.kind in ("band_limited", "turbulence"):
        return source.band_Hz[1]
    if source.kind == "measured":
        return (source.sampling_frequency_Hz or 0.0) / 2
    if source.kind == "harmonic":
        return source.frequency_Hz
    return 0.0
