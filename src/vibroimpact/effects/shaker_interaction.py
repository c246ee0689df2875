"""The shaker's moving parts belong to the structure."""

from dataclasses import replace

from . import lateral_stinger, places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with the armature at the drive point."""
    values = places.with_mass(values, "armature", location, parameters["mass"])
    laws = {
        "stiffness_N_per_m": parameters["stiffness"],
        "damping_N_s_per_m": parameters["damping"],
    }
    return places.with_element(
        values, "armature", location, places.across(values, location), **laws
    )


STIFFNESS, DAMPING = lateral_stinger.EFFECT.parameters
EFFECT = Effect(
    id="shaker_interaction",
    family="force",
    explanation="the moving parts of the shaker are carried by the structure",
    law="force = mass d2u/dt2 + damping du/dt + stiffness u at the drive point, along the force",
    source="G.R. Tomlinson, JSV 63 (1979)",
    parameters=(
        Parameter("mass", "kg", 0.002, 0.5, 0.0, per="mass", meaning="mass of the armature"),
        replace(STIFFNESS, meaning="stiffness of its suspension"),
        replace(DAMPING, meaning="damping of its suspension"),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    needs=("force", "voltage"),
    aliases=("added_mass", "lateral_stinger"),
    locations=lambda values: [values["excitation"]["point"]],
)
