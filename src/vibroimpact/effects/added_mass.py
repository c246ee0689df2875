"""A mass at a point of the structure."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with a point mass at a named point."""
    return places.with_mass(values, "added_mass", location, parameters["mass"])


EFFECT = Effect(
    id="added_mass",
    family="mass",
    explanation="the structure carries a mass that the model lacks",
    law="inertia force = mass times the acceleration of the point, in all directions",
    source="rigid point mass",
    parameters=(Parameter("mass", "kg", 0.002, 2.0, 0.0, per="mass", meaning="the point mass"),),
    apply=apply,
    linear=True,
    broken=("T1",),
    aliases=("mode_frequency_error", "root_stiffness"),
    locations=places.masses_and_springs,
)
