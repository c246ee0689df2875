"""Damping of the modes other than assumed."""

from .effect import Effect, Parameter, Values

LARGEST = (
    0.29  # damping ratio: a configuration takes no more than 0.3, of which no resonance is left
)


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with all modal damping ratios multiplied by a factor, to LARGEST at
    most.
    """
    damping, factor = dict(values["damping"]), parameters["factor"]
    for key in ("mass_coefficient_per_s", "stiffness_coefficient_s"):
        if key in damping:
            damping[key] = factor * damping[key]
    if "other_ratio" in damping:
        damping["other_ratio"] = min(factor * damping["other_ratio"], LARGEST)
    if "first_ratios" in damping:
        damping["first_ratios"] = [
            min(factor * ratio, LARGEST) for ratio in damping["first_ratios"]
        ]
    return values | {"damping": damping}


EFFECT = Effect(
    id="modal_damping",
    family="damping",
    explanation="the modes are damped otherwise than assumed",
    law="damping ratio of every mode = factor times the assumed one",
    source="viscous modal damping",
    parameters=(Parameter("factor", "1", 0.08, 30.0, 1.0, meaning="damping over the assumed one"),),
    apply=apply,
    linear=True,
    broken=("T1", "T5"),
    aliases=("fluid_added_mass_damping",),
)
