"""Hunt-Crossley damping of a support: it grows with the indentation."""

from . import places
from .effect import Effect, Parameter

EFFECT = Effect(
    id="hunt_crossley",
    called="Hunt-Crossley damping",
    family="contact damping",
    explanation="the contact dissipates with indentation times its speed",
    law="force = k p max(0, 1 + alpha dp/dt)",
    source="K.H. Hunt, F.R.E. Crossley, J. Appl. Mech. 42 (1975)",
    parameters=(
        Parameter(
            "alpha",
            "s/m",
            0.003,
            5.0,
            0.0,
            per="slowness",
            gain_power=-1.0,
            meaning="damping over stiffness and indentation",
        ),
    ),
    apply=places.at_supports(lambda own: {"hunt_crossley_s_per_m": own["alpha"]}),
    locations=places.supports,
    aliases=("contact_damping",),
    broken=("T2", "T5"),
)
