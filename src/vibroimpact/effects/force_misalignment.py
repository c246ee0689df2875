"""A force that is not along its stated direction."""

import math

from vibroimpact.effects.effect import Effect, Parameter


def apply(values, parameters, location):
    """Return the configuration with the force turned about z by an angle."""
    turned = values["excitation"].get("turn_deg", 0.0) + math.degrees(parameters["angle"])
    return values | {"excitation": values["excitation"] | {"turn_deg": turned}}


EFFECT = Effect(
    id="force_misalignment",
    explanation="the force is not along its stated direction",
    source="geometry",
    parameters=(
        Parameter("angle", "rad", -1.2, 1.2, 0.0, log=False),
    ),
    apply=apply,
    linear=True,
    broken=("T1", "T4"),
    locations=lambda values: ["force"],
)
