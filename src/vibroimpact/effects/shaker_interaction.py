"""The shaker's moving parts belong to the structure."""

from . import places
from .effect import Effect, Parameter


def apply(values, parameters, location):
    """Return the configuration with the armature at the drive point."""
    if parameters["mass"] > 0.0:
        values = values | {
            "masses": [
                *values["masses"],
                {"name": "armature", "point": location, "mass_kg": parameters["mass"]},
            ]
        }
    laws = {
        "stiffness_N_per_m": parameters["stiffness"],
        "damping_N_s_per_m": parameters["damping"],
    }
    return places.with_element(
        values, "armature", location, places.across(values, location), **laws
    )


EFFECT = Effect(
    id="shaker_interaction",
    explanation="the moving parts of the shaker are carried by the structure",
    source=(
        "armature of mass, spring and damper at the drive point, along the force; G.R. Tomlinson,"
        " JSV 63 (1979)"
    ),
    parameters=(
        Parameter("mass", "kg", 0.002, 0.5, 0.0, per="mass"),
        Parameter("stiffness", "N/m", 0.02, 20.0, 0.0, per="tube_translation"),
        Parameter("damping", "N s/m", 0.0, 1.0, 0.0, per="tube_damping", log=False, design=(0.1,)),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    needs=("voltage",),
    aliases=("added_mass", "lateral_stinger"),
    locations=places.driven,
)
