"""A hole of flat lands: the tube meets four planes in place of a circle."""

import math
from dataclasses import replace

from . import foliate_obstacle, places
from .effect import Effect
from .foliate_obstacle import LOBES

EFFECT = Effect(
    id="foliate_lands",
    called="hole with lands",
    family="shape of the hole",
    law_of="foliate_obstacle",
    explanation="the hole is not circular: four flat lands, the limit of its lobes",
    law=(
        "four planes at the distance gap from the centre, the first one at angle; force along the"
        " normal of the plane"
    ),
    source="limit of the lobes of foliate_obstacle",
    parameters=(replace(foliate_obstacle.EFFECT.parameters[1], neutral=None),),
    apply=places.at_supports(
        lambda own: {
            "profile": {
                "kind": "planes",
                "normals_deg": [
                    math.degrees(own["angle"]) + 360.0 / LOBES * land for land in range(LOBES)
                ],
            }
        }
    ),
    locations=places.holes,
    broken=("T4",),
    aliases=("dry_friction",),
)
