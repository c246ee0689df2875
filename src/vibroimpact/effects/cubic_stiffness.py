"""A spring that stiffens with the cube of its stretch."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a cubic spring between a point and the ground, along the
    force.
    """
    return places.with_element(
        values,
        "cubic_stiffness",
        location,
        places.across(values, location),
        cubic_N_per_m3=parameters["coefficient"],
    )


EFFECT = Effect(
    id="cubic_stiffness",
    called="cubic spring",
    family="spring",
    explanation="a spring stiffens with the amplitude",
    law="force = coefficient u^3, u along the force",
    source="Duffing spring",
    parameters=(
        Parameter(
            "coefficient",
            "N/m^3",
            0.01,
            300.0,
            0.0,
            per="cubic",
            gain_power=-2.0,
            meaning="coefficient of the cube",
        ),
    ),
    apply=apply,
    below_contact=True,
    broken=("T1", "T2"),
    aliases=("clearance",),
    locations=places.masses_and_springs,
)
