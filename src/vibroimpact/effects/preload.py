"""A constant force that presses the tube towards one side."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a constant force along x and y at the middle of a support, or
    of each of them.
    """
    chosen = [
        support
        for support in values["supports"]
        if support["at_m"] is not None and places.sits_at(support, location)
    ]
    loads = [
        {"point": f"at_{support['name']}", "direction": direction, "force_N": parameters[name]}
        for support in chosen
        for name, direction in (("force_x", [1.0, 0.0, 0.0]), ("force_y", [0.0, 1.0, 0.0]))
    ]
    excitation = values["excitation"] | {"constant": [*values["excitation"]["constant"], *loads]}
    return values | {
        "excitation": excitation,
        "points": (
            values["points"] | {f"at_{support['name']}": support["at_m"] for support in chosen}
        ),
    }


def locations(values: Values) -> list[str]:
    """Return all supports together, then one by one."""
    names = [
        support["name"]
        for support in values["supports"]
        if support["at_m"] is not None and support["name"] != places.STOP
    ]
    return ["all", *names] if len(names) > 1 else names


EFFECT = Effect(
    id="preload",
    family="clearance and position",
    explanation="a constant force presses the tube to one side",
    law="constant force on the tube at the middle of the support",
    source="statics",
    parameters=(
        Parameter(
            "force_x",
            "N",
            -5.0,
            5.0,
            0.0,
            per="gap_force",
            log=False,
            gain_power=1.0,
            meaning="force along x",
        ),
        Parameter(
            "force_y",
            "N",
            -5.0,
            5.0,
            0.0,
            per="gap_force",
            log=False,
            gain_power=1.0,
            meaning="force along y",
        ),
    ),
    apply=apply,
    locations=locations,
    broken=("T2", "T3", "T4"),
    aliases=("support_offset",),
)
