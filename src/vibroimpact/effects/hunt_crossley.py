"""Hunt-Crossley damping of a support: it grows with the indentation."""

from . import places
from .effect import Effect, Parameter


def apply(values, parameters, location):
    """Return the configuration with Hunt-Crossley damping at the supports of a location."""
    return places.with_supports(
        values, location, lambda support: {"hunt_crossley_s_per_m": parameters["alpha"]}
    )


EFFECT = Effect(
    id="hunt_crossley",
    explanation="the contact dissipates with indentation times its speed",
    source="K.H. Hunt, F.R.E. Crossley, J. Appl. Mech. 42 (1975): k p max(0, 1 + alpha dp/dt)",
    parameters=(Parameter("alpha", "s/m", 0.03, 30.0, 0.0, gain_power=-1.0),),
    apply=apply,
    locations=places.supports,
    aliases=("contact_damping",),
    quantity="contact damping",
    broken=("T2", "T5"),
)
