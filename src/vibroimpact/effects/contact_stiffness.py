"""The stiffness of a support."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with the total stiffness of the supports of a location."""
    return places.with_supports(
        values, location, lambda support: {"stiffness_N_per_m": parameters["stiffness"]}
    )


EFFECT = Effect(
    id="contact_stiffness",
    family="contact stiffness",
    explanation="the contact is softer or stiffer than assumed",
    law="force = stiffness p",
    source="linear contact spring",
    parameters=(
        Parameter(
            "stiffness",
            "N/m",
            0.005,
            10.0,
            None,
            per="contact_stiffness",
            meaning="stiffness of a support, total of its contact points",
        ),
    ),
    apply=apply,
    locations=places.supports,
    aliases=("hertz", "plate_flexibility"),
)
