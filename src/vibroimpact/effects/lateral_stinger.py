"""The shaker's rod holds the structure across the force."""

import numpy as np

from vibroimpact.geometry.directions import unit_vector

from . import places
from .effect import Effect, Parameter, Values

# cosine between the rod and the force: below it the rod holds a motion that the force hardly drives
ACROSS = 0.1
DIRECTIONS = {"along_x": (1.0, 0.0, 0.0), "along_y": (0.0, 1.0, 0.0), "along_z": (0.0, 0.0, 1.0)}


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


def locations(values: Values) -> list[str]:
    """Return the axes along which a rod may hold the structure: of a tube the two of x, y and z
    that are least along its start, where it is held: hardly any of it moves along the third.
    """
    along = places.start_direction(values)
    if along is None:
        return list(DIRECTIONS)
    out = int(np.argmax(np.abs(along)))
    return [name for number, name in enumerate(DIRECTIONS) if number != out]


def across_force(values: Values, location: str) -> bool:
    """Return whether a rod along a location is across the force."""
    force = unit_vector(values["excitation"]["direction"])
    return bool(abs(force @ np.array(DIRECTIONS[location])) < ACROSS)


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
    locations=locations,
)
