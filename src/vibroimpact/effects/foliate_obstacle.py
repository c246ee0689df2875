"""A hole with lobes: the tube meets lands in place of a circle."""

import math

from . import places
from .effect import Effect, Parameter


def lobed(count: int, id: str, source: str) -> Effect:
    """Return the effect of a hole of so many lobes, reported as foliate_obstacle."""
    return Effect(
        id=id,
        called="lobed hole",
        family="shape of the hole",
        law_of="" if id == REPORTED else REPORTED,
        explanation=f"the hole is not circular: {count} lobes, or flat lands as their limit",
        law=(
            f"r(theta) = gap + depth (1 - cos({count} (theta - angle))) / 2; force along the normal"
            " of the profile"
        ),
        source=source,
        parameters=(
            Parameter(
                "depth",
                "m",
                0.03,
                4.0,
                0.0,
                per="gap",
                gain_power=1.0,
                meaning="depth of the lobes",
            ),
            Parameter(
                "angle",
                "rad",
                0.0,
                2.0 * math.pi / count,
                0.0,
                log=False,
                meaning="direction of the first land",
            ),
        ),
        apply=places.at_supports(
            lambda own: {
                "profile": {
                    "kind": "lobes",
                    "count": count,
                    "depth_m": own["depth"],
                    "angle_deg": math.degrees(own["angle"]),
                }
            }
        ),
        locations=places.holes,
        broken=("T4",) if count % 2 == 0 else ("T3", "T4"),
        aliases=("dry_friction",),
    )


REPORTED = "foliate_obstacle"
LOBES = 4
EFFECT = lobed(LOBES, REPORTED, "a quadrifoil, as of broached support plates")
