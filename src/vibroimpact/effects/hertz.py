"""A contact that stiffens with the indentation."""

from . import places
from .effect import Effect, Parameter


def apply(values, parameters, location):
    """Return the configuration with Hertz contacts, the coefficient that of one contact point."""
    return places.with_supports(
        values,
        location,
        lambda support: {"hertz_N_per_m15": parameters["coefficient"] * support["points"]},
    )


EFFECT = Effect(
    id="hertz",
    explanation="the contact stiffens with the indentation (Hertz)",
    source="H. Hertz (1882): force = coefficient p^1.5",
    parameters=(
        Parameter("coefficient", "N/m^1.5", 0.005, 5.0, None, per="hertz", gain_power=-0.5),
    ),
    apply=apply,
    locations=places.supports,
    aliases=("contact_stiffness",),
    quantity="contact stiffness",
    broken=("T2",),
)
