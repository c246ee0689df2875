"""A constant force that presses the tube towards one side."""

from vibroimpact.effects.effect import Effect, Parameter


def apply(values, parameters, location):
    """Return the configuration with a constant force along x and y at the middle of a support."""
    (support,) = [support for support in values["supports"] if support["name"] == location]
    point = f"at_{location}"
    loads = [{"point": point, "direction": direction, "force_N": parameters[name]}
             for name, direction in (("force_x", [1.0, 0.0, 0.0]), ("force_y", [0.0, 1.0, 0.0]))]  # fmt: skip
    excitation = values["excitation"] | {"constant": [*values["excitation"]["constant"], *loads]}
    return values | {"excitation": excitation, "points": values["points"] | {point: support["at_m"]}}


def locations(values):
    """Return the supports one by one."""
    return [support["name"] for support in values["supports"] if support["at_m"] is not None]


EFFECT = Effect(
    id="preload",
    explanation="a constant force presses the tube to one side",
    source="statics",
    parameters=(
        Parameter("force_x", "N", -2.0, 2.0, 0.0, per="gap_force", log=False, design=(0.1, 0.5, 0.9)),
        Parameter("force_y", "N", -2.0, 2.0, 0.0, per="gap_force", log=False, design=(0.1, 0.5, 0.9)),
    ),
    apply=apply,
    locations=locations,
    broken=("T2", "T3", "T4"),
    aliases=("support_offset",),
)
