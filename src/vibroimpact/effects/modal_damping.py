"""Damping of the modes other than assumed."""

from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with all modal damping ratios multiplied by a factor."""
    damping = dict(values["damping"])
    for key in ("other_ratio", "mass_coefficient_per_s", "stiffness_coefficient_s"):
        if key in damping:
            damping[key] = parameters["factor"] * damping[key]
    if "first_ratios" in damping:
        damping["first_ratios"] = [
            parameters["factor"] * ratio for ratio in damping["first_ratios"]
        ]
    return values | {"damping": damping}


EFFECT = Effect(
    id="modal_damping",
    family="damping",
    explanation="the modes are damped otherwise than assumed",
    law="damping ratio of every mode = factor times the assumed one",
    source="viscous modal damping",
    parameters=(Parameter("factor", "1", 0.08, 12.0, 1.0, meaning="damping over the assumed one"),),
    apply=apply,
    linear=True,
    broken=("T1", "T5"),
    aliases=("fluid_added_mass_damping",),
)
