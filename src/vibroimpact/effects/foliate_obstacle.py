"""A hole with lobes: the tube meets lands in place of a circle."""

import math

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with four lobes at the supports of a location."""
    profile = {
        "kind": "lobes",
        "count": LOBES,
        "depth_m": parameters["depth"],
        "angle_deg": math.degrees(parameters["angle"]),
    }
    return places.with_supports(values, location, lambda support: {"profile": profile})


LOBES = 4


EFFECT = Effect(
    id="foliate_obstacle",
    family="shape of the hole",
    explanation="the hole is not circular: lobes, or flat lands as their limit",
    law=(
        "r(theta) = gap + depth (1 - cos(4 (theta - angle))) / 2; force along the normal of the"
        " profile"
    ),
    source="profile with four lobes",
    parameters=(
        Parameter(
            "depth",
            "m",
            0.03,
            1.5,
            0.0,
            per="gap",
            gain_power=1.0,
            meaning="depth of the lobes",
        ),
        Parameter(
            "angle",
            "rad",
            0.0,
            1.5707963267948966,
            0.0,
            log=False,
            meaning="direction of the first land",
        ),
    ),
    apply=apply,
    locations=places.holes,
    broken=("T4",),
    aliases=("dry_friction",),
)
