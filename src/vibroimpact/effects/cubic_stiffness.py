"""A spring that stiffens with the cube of its stretch."""

from . import places
from .effect import Effect, Parameter


def apply(values, parameters, location):
    """Return the configuration with a cubic spring between a point and the ground, along the
    force.
    """
    return places.with_element(
        values,
        "cubic_stiffness",
        location,
        places.across(values, location),
        cubic_N_per_m3=parameters["coefficient"],
    )


EFFECT = Effect(
    id="cubic_stiffness",
    explanation="a spring stiffens with the amplitude",
    source="Duffing: force = coefficient u^3",
    parameters=(Parameter("coefficient", "N/m^3", 0.01, 300.0, 0.0, per="cubic", gain_power=-2.0),),
    apply=apply,
    below_contact=True,
    broken=("T1", "T2"),
    aliases=("clearance",),
    locations=places.masses_and_springs,
)
