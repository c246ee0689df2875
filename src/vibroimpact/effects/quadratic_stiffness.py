"""A spring that is stiffer on one side."""

from . import places
from .effect import Effect, Parameter

EFFECT = Effect(
    id="quadratic_stiffness",
    called="quadratic spring",
    family="spring",
    explanation="a spring is stiffer to one side",
    law="force = coefficient u^2, u along the force",
    source="spring with an even term",
    parameters=(
        Parameter(
            "coefficient",
            "N/m^2",
            -0.15,
            0.15,
            0.0,
            per="quadratic",
            log=False,
            gain_power=-1.0,
            meaning="coefficient of the square",
        ),
    ),
    apply=places.at_a_point(
        "quadratic_stiffness", lambda own: {"quadratic_N_per_m2": own["coefficient"]}
    ),
    below_contact=True,
    broken=("T1", "T2", "T3"),
    aliases=("support_offset", "preload"),
    locations=places.masses_and_springs,
)
