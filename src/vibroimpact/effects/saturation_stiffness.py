"""A spring whose force saturates."""

from . import places
from .effect import Effect, Parameter

EFFECT = Effect(
    id="saturation_stiffness",
    called="saturating spring",
    family="spring",
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
            meaning="stiffness below the limit",
        ),
        Parameter(
            "limit", "N", 0.02, 50.0, 0.0, per="load", gain_power=1.0, meaning="largest force"
        ),
    ),
    apply=places.at_a_point(
        "saturation_stiffness",
        lambda own: {
            "saturation_stiffness_N_per_m": own["stiffness"],
            "saturation_limit_N": own["limit"],
        },
    ),
    below_contact=True,
    broken=("T1", "T2"),
    aliases=("coulomb_friction", "lateral_stinger"),
    locations=places.masses_and_springs,
)
