"""Coulomb friction of the contact, in proportion to its force."""

from . import places
from .effect import Effect, Parameter

EFFECT = Effect(
    id="dry_friction",
    family="friction",
    explanation="the contact rubs",
    law="tangential stick spring of the contact stiffness that slips at mu times the normal force",
    source="Coulomb friction",
    parameters=(Parameter("mu", "1", 0.01, 1.0, 0.0, meaning="coefficient of friction"),),
    apply=places.at_supports(lambda own: {"friction": own["mu"]}),
    locations=places.supports,
    broken=("T5",),
    aliases=("coulomb_friction", "foliate_obstacle"),
)
