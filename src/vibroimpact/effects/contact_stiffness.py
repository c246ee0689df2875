"""The stiffness of a support."""

from . import places
from .effect import Effect, Parameter

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
    apply=places.at_supports(lambda own: {"stiffness_N_per_m": own["stiffness"]}),
    locations=places.supports,
    aliases=("hertz", "plate_flexibility"),
)
