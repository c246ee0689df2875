"""The shaker's rod holds the structure across the force."""

from . import places
from .effect import Effect, Parameter, Values

DIRECTIONS = {"along_x": (1.0, 0.0, 0.0), "along_y": (0.0, 1.0, 0.0), "along_z": (0.0, 0.0, 1.0)}
ALONG = 1.0 - 1.0e-6  # cosine


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a spring and a damper at the drive point, along a global
    axis.
    """
    laws = {
        "stiffness_N_per_m": parameters["stiffness"],
        "damping_N_s_per_m": parameters["damping"],
    }
    return places.with_element(
        values, "lateral_stinger", values["excitation"]["point"], DIRECTIONS[location], **laws
    )


EFFECT = Effect(
    id="lateral_stinger",
    family="spring",
    explanation="the rod of the shaker holds the structure sideways or along the force",
    law="force = stiffness u + damping du/dt at the drive point, along a global axis",
    source="spring and damper",
    parameters=(
        Parameter(
            "stiffness",
            "N/m",
            0.02,
            20.0,
            0.0,
            per="tube_translation",
            meaning="stiffness of the rod",
        ),
        Parameter(
            "damping",
            "N s/m",
            0.0,
            1.0,
            0.0,
            per="tube_damping",
            log=False,
            meaning="damping of the rod",
        ),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    needs=("force",),
    locations=lambda values: list(DIRECTIONS),
)
