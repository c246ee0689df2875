"""The shaker's moving parts belong to the structure."""

from . import places
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


EFFECT = Effect(
    id="shaker_interaction",
    family="force",
    explanation="the moving parts of the shaker are carried by the structure",
    law="force = mass d2u/dt2 + damping du/dt + stiffness u at the drive point, along the force",
    source="G.R. Tomlinson, JSV 63 (1979)",
    parameters=(
        Parameter("mass", "kg", 0.002, 0.5, 0.0, per="mass", meaning="mass of the armature"),
        Parameter(
            "stiffness",
            "N/m",
            0.02,
            20.0,
            0.0,
            per="tube_translation",
            meaning="stiffness of its suspension",
        ),
        Parameter(
            "damping",
            "N s/m",
            0.0,
            1.0,
            0.0,
            per="tube_damping",
            log=False,
            meaning="damping of its suspension",
        ),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    needs=("force", "voltage"),
    aliases=("added_mass", "lateral_stinger"),
    locations=places.driven,
)
