"""Ends that give way: springs in place of clamps."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with both ends of the tube on springs."""
    ends = {
        "kind": "springs",
        "translation_N_per_m": parameters["translation"],
        "rotation_N_m_per_rad": parameters["rotation"],
    }
    keys = ("root",) if values["structure"]["kind"] == "u_tube" else ("start", "end")
    return values | {"structure": values["structure"] | dict.fromkeys(keys, ends)}


EFFECT = Effect(
    id="root_stiffness",
    family="spring",
    explanation="the roots are not clamped",
    law="force = translation u and moment = rotation times the slope, at both ends",
    source="springs in place of clamps",
    parameters=(
        Parameter(
            "translation",
            "N/m",
            30.0,
            3.0e5,
            None,
            per="tube_translation",
            meaning="stiffness against translation",
        ),
        Parameter(
            "rotation",
            "N m/rad",
            0.1,
            1.0e3,
            None,
            per="tube_rotation",
            meaning="stiffness against rotation",
        ),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    aliases=("mode_frequency_error", "added_mass"),
    locations=lambda values: ["roots"] if values["structure"]["kind"] in places.TUBES else [],
)
