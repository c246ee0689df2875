"""A stop on one side, at a point that the model leaves free."""

from dataclasses import replace

from . import clearance, places
from .effect import Effect, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a flat stop at a point, in the direction of the force there; a
    location that is turned by 180 degrees has it on the other side.
    """
    along = places.across_deg(values, location)
    return places.with_stops(values, location, parameters["stiffness"], parameters["gap"], [along])


GAP, STIFFNESS = clearance.EFFECT.parameters
EFFECT = Effect(
    id="one_sided_stop",
    called="stop on one side",
    family="spring",
    explanation="a stop on one side that the model lacks",
    law="force = stiffness (u - gap) beyond gap, 0 below it; u along the force, or against it",
    source="unilateral spring",
    parameters=(
        replace(GAP, name="gap", meaning="distance to the stop"),
        replace(STIFFNESS, meaning="stiffness of the stop"),
    ),
    apply=apply,
    below_contact=True,
    broken=("T1", "T2", "T3"),
    aliases=("clearance",),
    locations=places.stops,
)
