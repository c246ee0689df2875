"""The shaker's rod holds the structure across the force."""

import numpy as np

from vibroimpact.geometry.directions import unit_vector

from . import places
from .effect import Effect, Parameter, Values

ALONG = 0.995  # cosine between a force and a global axis: from it on the force is along the axis
AXES = {"along_x": (1.0, 0.0, 0.0), "along_y": (0.0, 1.0, 0.0), "along_z": (0.0, 0.0, 1.0)}
ALONG_FORCE = "along_force"


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a spring and a damper at the drive point, along a global axis
    or the force.
    """
    force = values["excitation"]
    laws = {
        "stiffness_N_per_m": parameters["stiffness"],
        "damping_N_s_per_m": parameters["damping"],
    }
    held = AXES.get(location) or force["direction"]  # along_force is no axis
    return places.with_element(values, "lateral_stinger", force["point"], held, **laws)


def locations(values: Values) -> list[str]:
    """Return the directions along which a rod may hold the structure: that of a force that is along
    no axis, and x, y and z; for a tube the two of these that are least along its held start: hardly
    any of it moves along the third.
    """
    force = values["excitation"].get("direction")  # none for a load along a whole tube
    oblique = force is not None and np.abs(unit_vector(force)).max() < ALONG
    names = [ALONG_FORCE] if oblique else []
    start = places.start_direction(values)
    out = None if start is None else int(np.argmax(np.abs(start)))
    return names + [name for number, name in enumerate(AXES) if number != out]


EFFECT = Effect(
    id="lateral_stinger",
    family="spring",
    explanation="the rod of the shaker holds the structure sideways or along the force",
    law="force = stiffness u + damping du/dt at the drive point, along an axis or the force",
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
