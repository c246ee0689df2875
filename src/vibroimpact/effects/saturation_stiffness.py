"""A spring whose force saturates."""

from . import places
from .effect import Effect, Parameter, Values
from .lateral_stinger import along_the_force


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a saturating spring between a point and the ground, along the
    force.
    """
    laws = {
        "saturation_stiffness_N_per_m": parameters["stiffness"],
        "saturation_limit_N": parameters["limit"],
    }
    return places.with_element(
        values, "saturation_stiffness", location, places.across(values, location), **laws
    )


def rounded(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a spring that saturates gradually, as a grip does, or a clamp
    that opens.
    """
    laws = {
        "saturation_stiffness_N_per_m": parameters["stiffness"],
        "saturation_limit_N": parameters["limit"],
    }
    return places.side_by_side(
        values, "saturation_stiffness", location, places.across(values, location), **laws
    )


EFFECT = Effect(
    id="saturation_stiffness",
    explanation="a spring holds up to a limit only",
    law="force = stiffness u, at most +-limit; u along the force",
    source="spring with a limit",
    parameters=(
        Parameter(
            "stiffness",
            "N/m",
            0.05,
            50.0,
            0.0,
            per="tube_translation",
            design=(0.2, 0.5, 0.8),
            meaning="stiffness below the limit",
        ),
        Parameter(
            "limit",
            "N",
            0.02,
            10.0,
            0.0,
            per="load",
            design=(0.2, 0.5, 0.8),
            gain_power=1.0,
            meaning="largest force",
        ),
    ),
    apply=apply,
    below_contact=True,
    broken=("T1", "T2"),
    aliases=("coulomb_friction", "lateral_stinger"),
    locations=places.masses_and_springs,
    other_laws=(rounded,),
    unlimited=along_the_force,
)
