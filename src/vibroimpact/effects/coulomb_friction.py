"""Dry friction of constant force at a point."""

from . import places
from .effect import Effect, Parameter

STICK_PER_FORCE = 1.0e5  # 1/m: it slips after 10 micrometres

EFFECT = Effect(
    id="coulomb_friction",
    called="Coulomb friction",
    family="damping",
    explanation="something rubs with a constant force",
    law="elastic stick spring that slips at +-force; u along the force",
    source="Coulomb friction with an elastic stick spring (Jenkins element)",
    parameters=(
        Parameter(
            "force",
            "N",
            0.003,
            2.0,
            0.0,
            per="load",
            gain_power=1.0,
            meaning="force at which it slips",
        ),
    ),
    apply=places.at_a_point(
        "coulomb_friction",
        lambda own: {
            "slip_limit_N": own["force"],
            "stick_stiffness_N_per_m": STICK_PER_FORCE * own["force"],
        },
    ),
    below_contact=True,
    broken=("T1", "T2", "T5"),
    aliases=("saturation_stiffness", "dry_friction"),
    locations=places.masses_and_springs,
)
