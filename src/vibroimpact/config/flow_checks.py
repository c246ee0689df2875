"""The checks of a flow across the tube."""

from __future__ import annotations

from typing import Any

from vibroimpact.geometry.sections import outer_width

from .excitation import Excitation
from .flow import Flow
from .geometry_checks import Tube
from .key_problem import Problem, Problems
from .structure import Structure
from .turbulence_checks import direction_of_flow, points_of_spectrum, stretches_of_flow


def acts_along_a_tube(structure: Structure, flow: Flow) -> Problems:
    """Yield a problem: a flow acts along a tube, and this structure is none."""
    yield Problem(
        "flow", f"acts along a tube, structure.kind is {structure.kind}: leave it out", "..."
    )


def stretches(structure: Tube, flow: Flow) -> Problems:
    """Yield a problem unless the stretches of the flow are on the tube and do not overlap."""
    yield from stretches_of_flow(structure, flow.stretches, "flow")


def direction(structure: Tube, flow: Flow) -> Problems:
    """Yield a problem unless the fluid-elastic force is across the tube wherever it acts."""
    yield from direction_of_flow(structure, flow, "flow")


def pitch(structure: Tube, flow: Flow) -> Problems:
    """Yield a problem unless neighbouring tubes leave a gap."""
    width = outer_width(structure.section)
    if flow.criterion.kind == "tema" and flow.criterion.pitch_m <= width:
        yield Problem(
            "flow.criterion.pitch_m",
            f"is not above the diameter of the tube, {width:g} m: give the distance of two axes",
        )


def lags(flow: Flow) -> Problems:
    """Yield a problem unless each lag has an amplitude and a rate."""
    own = flow.coupling
    if own is not None and own.kind == "lags" and len(own.amplitudes) != len(own.rates):
        yield Problem(
            "flow.coupling.rates",
            f"has {len(own.rates)} values, amplitudes has {len(own.amplitudes)}: give one of each"
            " per lag",
        )


def acting(flow: Flow) -> Problems:
    """Yield a problem unless a flow that acts has a force."""
    if flow.acting_m_per_s is not None and flow.coupling is None:
        yield Problem(
            "flow.acting_m_per_s",
            "acts through flow.coupling, and there is none: give one, or leave acting_m_per_s out",
        )


def fitted_range(flow: Flow) -> Problems:
    """Yield a problem unless the reduced velocities of a fit ascend."""
    own = getattr(flow.coupling, "reduced_velocity", None)
    if own is not None and own[0] >= own[1]:
        yield Problem("flow.coupling.reduced_velocity", "must ascend: give the lower one first")


def following(excitation: Excitation, flow: Flow) -> Problems:
    """Yield a problem unless turbulence that follows the velocity has a dimensionless spectrum."""
    if flow.turbulence is None or flow.turbulence.kind != "dimensionless":
        return
    if excitation.kind != "turbulence" or not hasattr(excitation.spectrum, "velocity_m_per_s"):
        yield Problem(
            "flow.turbulence.kind",
            "needs excitation.kind turbulence with a spectrum of a velocity, such as tube_bundle:"
            " give one, or turbulence of kind power",
        )


def covered(structure: Tube, excitation: Excitation, flow: Flow) -> Problems:
    """Yield a problem unless a table of reduced frequencies covers the band at each velocity."""
    spectrum: Any = getattr(excitation, "spectrum", None)
    if flow.turbulence is None or getattr(spectrum, "kind", "") != "reduced_table":
        return
    for velocity in flow.velocity_m_per_s if flow.turbulence.kind == "dimensionless" else ():
        moved = spectrum.model_copy(update={"velocity_m_per_s": velocity})
        own = excitation.model_copy(update={"spectrum": moved})
        for each in points_of_spectrum(structure, own):
            yield Problem(
                "flow.velocity_m_per_s", f"is too far for the spectrum, which {each.text}", velocity
            )
