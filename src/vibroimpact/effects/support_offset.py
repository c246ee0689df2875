"""A support whose centre is off the axis of the tube."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with the centres of a location moved; x and y are the support's two
    transverse directions.
    """
    return places.with_supports(
        values,
        location,
        lambda support: {"centre_offset_m": [parameters["offset_x"], parameters["offset_y"]]},
    )


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
    apply=apply,
    locations=places.supports,
    broken=("T2", "T3", "T4"),
    aliases=("preload",),
)
