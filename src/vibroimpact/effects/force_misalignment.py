"""A force that is not along its stated direction."""

import math

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with the force turned by an angle, about_z or about_tube: the
    tangent at the force.
    """
    turned = values["excitation"].get("turn_deg", 0.0) + math.degrees(parameters["angle"])
    turn = {"turn_deg": turned, "turn_about": location.removeprefix("about_")}
    return values | {"excitation": values["excitation"] | turn}


EFFECT = Effect(
    id="force_misalignment",
    family="force",
    explanation="the force is not along its stated direction",
    law="the direction of the force is turned by angle, about z or about the tube",
    source="geometry",
    parameters=(Parameter("angle", "rad", -1.2, 1.2, 0.0, log=False, meaning="angle of the turn"),),
    apply=apply,
    linear=True,
    broken=("T1", "T4"),
    needs=("force",),
    locations=lambda values: (
        ["about_z", "about_tube"] if values["structure"]["kind"] in places.TUBES else ["about_z"]
    ),
)
