"""A fluid that moves with the tube and takes energy from it."""

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.sections import section_properties
from vibroimpact.structure.fluid import mean_fluid_mass

from . import places
from .effect import Effect, Parameter, Values

MOST_DENSE = 3.0e4  # kg/m3 of the wall with its fluid: no configuration takes more


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with the mass as density of the wall and the drag as damping in
    proportion to the mass.
    """
    structure = values["structure"]
    material, settings = structure["material"], StageSettings(structure)
    area = section_properties(settings.section, material["poisson_ratio"]).area
    density = min(material["density_kg_per_m3"] + parameters["mass"] / area, MOST_DENSE)
    mass_per_length = density * area + mean_fluid_mass(settings, build_centreline(settings))
    damping = dict(values["damping"])
    damping["mass_coefficient_per_s"] = (
        damping.get("mass_coefficient_per_s", 0.0) + parameters["damping"] / mass_per_length
    )
    return values | {
        "structure": structure | {"material": material | {"density_kg_per_m3": density}},
        "damping": damping,
    }


EFFECT = Effect(
    id="fluid_added_mass_damping",
    called="mass and damping of a fluid",
    family="damping",
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
            meaning="damping per length of tube",
        ),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    aliases=("modal_damping", "added_mass"),
    locations=lambda values: ["tube"] if values["structure"]["kind"] in places.TUBES else [],
)
