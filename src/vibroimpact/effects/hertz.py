"""A contact that stiffens with the indentation."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with Hertz contacts, the coefficient that of one contact point."""
    return places.with_supports(
        values,
        location,
        lambda support: {"hertz_N_per_m15": parameters["coefficient"] * support["points"]},
    )


EFFECT = Effect(
    id="hertz",
    called="Hertz contact",
    family="contact stiffness",
    explanation="the contact stiffens with the indentation (Hertz)",
    law="force = coefficient p^1.5 at each contact point",
    source="H. Hertz (1882)",
    parameters=(
        Parameter(
            "coefficient",
            "N/m^1.5",
            0.001,
            1.0,
            None,
            per="hertz",
            gain_power=-0.5,
            meaning="coefficient of one contact point",
        ),
    ),
    apply=apply,
    locations=places.supports,
    aliases=("contact_stiffness",),
    broken=("T2",),
)
