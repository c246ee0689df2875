"""A support whose centre is off the axis of the tube."""

from . import places
from .effect import Effect, Parameter

EFFECT = Effect(
    id="support_offset",
    family="clearance and position",
    explanation="the support is not centred on the tube",
    law="the centre of the support lies at (offset_x, offset_y) in its plane",
    source="geometry",
    parameters=tuple(
        Parameter(
            f"offset_{axis}",
            "m",
            -1.5,
            1.5,
            0.0,
            per="gap",
            log=False,
            gain_power=1.0,
            meaning=f"offset along the {word} transverse direction",
        )
        for axis, word in (("x", "first"), ("y", "second"))
    ),
    apply=places.at_supports(lambda own: {"centre_offset_m": [own["offset_x"], own["offset_y"]]}),
    locations=places.supports,
    broken=("T2", "T3", "T4"),
    aliases=("preload",),
)
