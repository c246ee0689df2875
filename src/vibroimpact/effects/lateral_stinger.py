"""The shaker's rod holds the structure across the force."""

import numpy as np

from . import places
from .effect import Effect, Parameter

DIRECTIONS = {"along_x": (1.0, 0.0, 0.0), "along_y": (0.0, 1.0, 0.0), "along_z": (0.0, 0.0, 1.0)}
ALONG = 1.0 - 1.0e-6  # cosine


def apply(values, parameters, location):
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


def along_the_force(values, point):
    """Return the (id, axis) of a stinger that holds as a spring along the force at a point does,
    None off the drive point, or where the force is along no axis.
    """
    force = np.array(values["excitation"]["direction"]) / np.linalg.norm(
        values["excitation"]["direction"]
    )
    axes = [name for name, axis in DIRECTIONS.items() if abs(force @ axis) > ALONG]
    return ("lateral_stinger", axes[0]) if axes and [point] == places.driven(values) else None


EFFECT = Effect(
    id="lateral_stinger",
    explanation="the rod of the shaker holds the structure sideways or along the force",
    source="spring and damper between the drive point and the ground",
    parameters=(
        Parameter("stiffness", "N/m", 0.02, 20.0, 0.0, per="tube_translation"),
        Parameter("damping", "N s/m", 0.0, 1.0, 0.0, per="tube_damping", log=False, design=(0.1,)),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    locations=lambda values: list(DIRECTIONS),
)
