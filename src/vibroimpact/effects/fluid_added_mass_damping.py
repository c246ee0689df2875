"""A fluid that moves with the tube and takes energy from it."""

import math

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with the mass as density of the wall and the drag as damping in
    proportion to the mass.
    """
    structure, section = values["structure"], values["structure"]["section"]
    inner = section["outer_diameter_m"] - 2.0 * section["wall_thickness_m"]
    area = 0.25 * math.pi * (section["outer_diameter_m"] ** 2 - inner**2)
    material = structure["material"]
    density = material["density_kg_per_m3"] + parameters["mass"] / area
    damping = dict(values["damping"])
    damping["mass_coefficient_per_s"] = damping.get("mass_coefficient_per_s", 0.0) + parameters[
        "damping"
    ] / (density * area)
    return values | {
        "structure": structure | {"material": material | {"density_kg_per_m3": density}},
        "damping": damping,
    }


EFFECT = Effect(
    id="fluid_added_mass_damping",
    explanation="a fluid adds mass and damping along the tube",
    law="force per length = mass a + damping v, along the whole tube",
    source="added mass and linear drag",
    parameters=(
        Parameter(
            "mass",
            "kg/m",
            0.005,
            2.0,
            0.0,
            per="mass_per_length",
            meaning="added mass per length of tube",
        ),
        Parameter(
            "damping",
            "N s/m^2",
            0.0,
            20.0,
            0.0,
            per="damping_per_length",
            log=False,
            design=(0.1,),
            meaning="damping per length of tube",
        ),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    aliases=("modal_damping", "added_mass"),
    locations=lambda values: ["tube"] if values["structure"]["kind"] in places.TUBES else [],
)
