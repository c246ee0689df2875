"""A stop behind a clearance, at a point that the model leaves free."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a pair of flat stops at a point along the force; of a tube,
    across it.
    """
    along = places.across_deg(values, location)
    return places.with_stops(
        values, location, parameters["stiffness"], parameters["half_gap"], [along, along - 180.0]
    )


EFFECT = Effect(
    id="clearance",
    called="stop behind a clearance",
    family="spring",
    explanation="a stop behind a clearance that the model lacks",
    law="force = stiffness (|u| - half_gap) beyond half_gap, 0 within it; u along the force",
    source="dead zone",
    parameters=(
        Parameter(
            "half_gap",
            "m",
            0.05,
            3.0,
            None,
            per="displacement",
            gain_power=1.0,
            meaning="distance to the stop on either side",
        ),
        Parameter(
            "stiffness",
            "N/m",
            0.1,
            1000.0,
            None,
            per="tube_translation",
            meaning="stiffness of the stops",
        ),
    ),
    apply=apply,
    below_contact=True,
    broken=("T1", "T2"),
    aliases=("cubic_stiffness",),
    locations=places.stops,
)
