"""Damping of the modes other than assumed."""

from .effect import Effect, Parameter, Values

# Damping ratio: a configuration takes less than 0.3, at which no resonance is left.
LARGEST = 0.29


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with all modal damping ratios multiplied by a factor, to LARGEST at
    most if they are not larger already.
    """
    damping, factor = dict(values["damping"]), parameters["factor"]

    def damped(ratio):
        return min(factor * ratio, max(ratio, LARGEST))

    for key in ("mass_coefficient_per_s", "stiffness_coefficient_s"):
        if key in damping:
            damping[key] = factor * damping[key]
    if "other_ratio" in damping:
        damping["other_ratio"] = damped(damping["other_ratio"])
    if "first_ratios" in damping:
        damping["first_ratios"] = [damped(ratio) for ratio in damping["first_ratios"]]
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
