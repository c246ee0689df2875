"""Kelvin-Voigt damping of a support: it pushes, and never pulls."""

from . import places
from .effect import Effect, Parameter

EFFECT = Effect(
    id="contact_damping",
    family="contact damping",
    explanation="the contact dissipates with the speed of the indentation",
    law="force = max(0, k p + damping dp/dt); it never pulls",
    source="Kelvin-Voigt",
    parameters=(
        Parameter(
            "damping",
            "N s/m",
            2.0e-6,
            3.0e-3,
            0.0,
            per="contact_stiffness",
            meaning="damping of a support, total of its contact points",
        ),
    ),
    apply=places.at_supports(lambda own: {"damping_N_s_per_m": own["damping"]}),
    locations=places.supports,
    aliases=("hunt_crossley",),
    broken=("T5",),
)
