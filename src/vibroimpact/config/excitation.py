"""What a configuration says about the forces: where they act and how they vary in time."""

from __future__ import annotations

from typing import Annotated, Literal

from .quantities import Band_Hz, Frequency_Hz, Name, Number, Section, Vector, choice, within

Phase_deg = Annotated[
    Number, within("in degrees, between -360 and 360", at_least=-360, at_most=360)
]


class ForcePoint(Section):
    """One more point that the force of the case acts at: factor times the force, along the
    direction.
    """

    point: Name
    direction: Vector
    factor: Number = 1.0


class Distributed(Section):
    """A part of the tube that the force of the case is spread over, factor_per_m times the force on
    each metre.
    """

    from_m: Vector
    to_m: Vector
    direction: Vector
    factor_per_m: Number


class DeadLoad(Section):
    """A constant force at a point."""

    point: Name
    direction: Vector
    force_N: Number


class Forces(Section):
    """Where the force of the case acts: factor times the force at the point, and what is listed
    under `also` and `distributed`.

    turn_deg: angle by which the force at the point acts away from its stated direction,
    right-handed about turn_about: z, or the tangent of the tube there.
    """

    point: Name
    direction: Vector
    turn_deg: Phase_deg = 0.0
    turn_about: Literal["z", "tube"] = "z"
    factor: Number = 1.0
    also: tuple[ForcePoint, ...] = ()
    distributed: tuple[Distributed, ...] = ()
    constant: tuple[DeadLoad, ...] = ()


class BandLimited(Forces):
    """A Gaussian force with a flat one-sided PSD in a band."""

    kind: Literal["band_limited"]
    band_Hz: Band_Hz


class Measured(Forces):
    """A measured force record (netCDF, CSV or MAT), scaled to the load of the case."""

    kind: Literal["measured"]
    file: str
    variable: str
    sampling_frequency_Hz: Frequency_Hz | None = None


class Harmonic(Forces):
    """A sine: sqrt(2) load sin(2 pi frequency t + phase), t = 0 at the start of the record (of the
    run where every step is kept).
    """

    kind: Literal["harmonic"]
    frequency_Hz: Frequency_Hz
    phase_deg: Phase_deg = 0.0


class WhiteNoise(Forces):
    """An independent Gaussian value at every step: one-sided PSD 2 load² / steps_per_second."""

    kind: Literal["white_noise"]


class Still(Section):
    """No force that varies: free motion from the initial state, under dead loads if there are any.
    The load of a case means nothing.
    """

    kind: Literal["none"]
    constant: tuple[DeadLoad, ...] = ()


class BandSignal(Section):
    """A Gaussian signal with a flat one-sided PSD in a band."""

    kind: Literal["band_limited"]
    band_Hz: Band_Hz


class HarmonicSignal(Section):
    """A sine of the case's RMS."""

    kind: Literal["harmonic"]
    frequency_Hz: Frequency_Hz
    phase_deg: Phase_deg = 0.0


class BaseMotion(Section):
    """The acceleration of all that holds the structure; the load of a case is its RMS in m/s² (N
    per kg).

    obstacles: `moving` with the base, or `fixed` in space. Displacements of sensors are relative to
    the base; those of contacts with fixed obstacles are absolute.
    """

    kind: Literal["base_motion"]
    direction: Vector
    obstacles: Literal["moving", "fixed"] = "moving"
    signal: choice(BandSignal, HarmonicSignal)
    constant: tuple[DeadLoad, ...] = ()


Excitation = choice(BandLimited, Measured, Harmonic, WhiteNoise, Still, BaseMotion)
