"""A spring that stiffens with the cube of its stretch."""

from . import places
from .effect import Effect, Parameter

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
    apply=places.at_a_point("cubic_stiffness", lambda own: {"cubic_N_per_m3": own["coefficient"]}),
    below_contact=True,
    broken=("T1", "T2"),
    aliases=("clearance",),
    locations=places.masses_and_springs,
)
