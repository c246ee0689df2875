"""A support whose clearance is not the nominal one."""

from . import places
from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with the clearances of a location multiplied by gap_factor."""
    factor = parameters["gap_factor"]

    def change(support: Values) -> Values:
        own = {} if support["gap_m"] is None else {"gap_m": factor * support["gap_m"]}
        given = support["gap_factor"]  # a number, or one per contact point
        several = isinstance(given, (list, tuple))
        times = [factor * value for value in given] if several else factor * given
        return own | {"gap_factor": times}

    return places.with_supports(values, location, change)


EFFECT = Effect(
    id="gap",
    family="clearance and position",
    explanation="the radial clearance differs from the nominal one",
    law="clearance = gap_factor times the nominal clearance",
    source="scaling: q / gap depends on force / gap alone",
    parameters=(
        Parameter(
            "gap_factor",
            "1",
            0.25,
            4.0,
            1.0,
            gain_power=1.0,
            meaning="clearance over its nominal value",
        ),
    ),
    apply=apply,
    locations=places.supports,
    aliases=("sensor_gain",),
)
