"""The checks of a flow across the tube."""

from vibroimpact.geometry.sections import outer_width

from .key_problem import Problem, Problems
from .stage_settings import ConfigPart
from .turbulence_checks import points_of_spectrum


def acts_along_a_tube(other: ConfigPart, flow: ConfigPart) -> Problems:
    """Yield a problem: a flow acts along a tube, and this structure is none."""
    yield Problem("flow", f"acts along a tube, structure.kind is {other.kind}: leave it out", "...")


def pitch(tube: ConfigPart, flow: ConfigPart) -> Problems:
    """Yield a problem unless neighbouring tubes leave a gap."""
    width = outer_width(tube.section)
    if flow.criterion.kind == "tema" and flow.criterion.pitch_m <= width:
        yield Problem(
            "flow.criterion.pitch_m",
            f"is not above the diameter of the tube, {width:g} m: give the distance of two axes",
        )


def coupling(flow: ConfigPart) -> Problems:
    """Yield a problem unless each lag has an amplitude and a rate, a flow that acts has a force,
    and the reduced velocities of a fit ascend.
    """
    own = flow.coupling
    if own is not None and own.kind == "lags" and len(own.amplitudes) != len(own.rates):
        yield Problem(
            "flow.coupling.rates",
            f"has {len(own.rates)} values, amplitudes has {len(own.amplitudes)}: give one of each"
            " per lag",
        )
    if flow.acting_m_per_s is not None and own is None:
        yield Problem(
            "flow.acting_m_per_s",
            "acts through flow.coupling, and there is none: give one, or leave acting_m_per_s out",
        )
    fitted = getattr(own, "reduced_velocity", None)
    if fitted is not None and fitted[0] >= fitted[1]:
        yield Problem("flow.coupling.reduced_velocity", "must ascend: give the lower one first")


def following(excitation: ConfigPart, flow: ConfigPart) -> Problems:
    """Yield a problem unless turbulence that follows the velocity has a dimensionless spectrum."""
    if flow.turbulence is None or flow.turbulence.kind != "dimensionless":
        return
    if excitation.kind != "turbulence" or not hasattr(excitation.spectrum, "velocity_m_per_s"):
        yield Problem(
            "flow.turbulence.kind",
            "needs excitation.kind turbulence with a spectrum of a velocity, such as tube_bundle:"
            " give one, or turbulence of kind power",
        )


def covered(tube: ConfigPart, turbulence: ConfigPart, flow: ConfigPart) -> Problems:
    """Yield a problem unless a table of reduced frequencies covers the band at each velocity."""
    spectrum = turbulence.spectrum
    follows = flow.turbulence is not None and flow.turbulence.kind == "dimensionless"
    if not follows or spectrum.kind != "reduced_table":
        return
    for velocity in flow.velocity_m_per_s:
        moved = spectrum.model_copy(update={"velocity_m_per_s": velocity})
        own = turbulence.model_copy(update={"spectrum": moved})
        for each in points_of_spectrum(tube, own):
            yield Problem(
                "flow.velocity_m_per_s", f"is too far for the spectrum, which {each.text}", velocity
            )
