"""A plate that gives way: a mass on a spring carries the support."""

from . import places
from .effect import Effect, Parameter

EFFECT = Effect(
    id="plate_flexibility",
    family="contact stiffness",
    explanation="the support plate moves",
    law="the support sits on a mass on a damped spring, in both transverse directions",
    source="single-degree-of-freedom plate",
    parameters=(
        Parameter(
            "stiffness",
            "N/m",
            0.002,
            8.0,
            None,
            per="contact_stiffness",
            over="mass",
            meaning="stiffness of the plate",
        ),  # the plate's own frequency
        Parameter("mass", "kg", 0.01, 3.0, None, per="mass", meaning="mass of the plate"),
        Parameter("damping_ratio", "1", 0.005, 0.29, None, meaning="damping ratio of the plate"),
    ),
    apply=places.at_supports(
        lambda own: {
            "plate": {
                "mass_kg": own["mass"],
                "stiffness_N_per_m": own["stiffness"],
                "damping_ratio": own["damping_ratio"],
            }
        }
    ),
    locations=places.supports,
    aliases=("contact_stiffness",),
)
