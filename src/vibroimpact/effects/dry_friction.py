"""Coulomb friction of the contact, in proportion to its force."""

from . import places
from .effect import Effect, Parameter


def apply(values, parameters, location):
    """Return the configuration with friction at the supports of a location."""
    return places.with_supports(values, location, lambda support: {"friction": parameters["mu"]})


EFFECT = Effect(
    id="dry_friction",
    explanation="the contact rubs",
    source="Coulomb; elastic stick spring of the contact stiffness",
    parameters=(Parameter("mu", "1", 0.01, 1.0, 0.0),),
    apply=apply,
    locations=places.supports,
    broken=("T5",),
    aliases=("coulomb_friction", "foliate_obstacle"),
)
