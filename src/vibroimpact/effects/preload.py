"""A constant force that presses the tube towards one side."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a constant force at the middle of a support, or of each of
    them, along its two transverse directions.
    """
    chosen = [support for support in values["supports"] if places.sits_at(support, location)]
    points = {
        f"at_{support['name']}": support["at_m"]
        for support in chosen
        if support["at_m"] is not None
    }
    loads = [
        {
            "point": support["point"] or f"at_{support['name']}",
            "direction": [float(x) for x in direction],
            "force_N": parameters[name],
        }
        for support in chosen
        for name, direction in zip(
            ("force_x", "force_y"), places.axes_across(values, support["at_m"]), strict=True
        )
    ]
    excitation = values["excitation"] | {"constant": [*values["excitation"]["constant"], *loads]}
    return values | {"excitation": excitation, "points": values["points"] | points}


EFFECT = Effect(
    id="preload",
    family="clearance and position",
    explanation="a constant force presses the tube to one side",
    law="constant force on the tube at the middle of the support",
    source="statics",
    parameters=tuple(
        Parameter(
            f"force_{axis}",
            "N",
            -5.0,
            5.0,
            0.0,
            per="gap_force",
            log=False,
            gain_power=1.0,
            meaning=f"force along the {word} transverse direction",
        )
        for axis, word in (("x", "first"), ("y", "second"))
    ),
    apply=apply,
    locations=places.supports,
    broken=("T2", "T3", "T4"),
    aliases=("support_offset",),
)
