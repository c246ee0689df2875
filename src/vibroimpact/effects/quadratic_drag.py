"""A fluid whose drag grows with the square of the speed."""

from . import places
from .effect import Effect, Parameter, Values

STATIONS = 8


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with drag at evenly spaced stations of the tube, in the two
    directions across it.
    """
    points, length = places.stations(values, STATIONS)
    values = values | {"points": values["points"] | points}
    coefficient = parameters["coefficient"] * length
    for name, place in points.items():
        for number, direction in enumerate(places.axes_across(values, place)):
            drag = {"drag_N_s2_per_m2": coefficient, "drag_partner": f"drag_{name}_{'yx'[number]}"}
            along = [float(x) for x in direction]
            values = places.with_element(
                values, f"drag_{name}_{'xy'[number]}", name, along, **drag if coefficient else {}
            )
    return values


EFFECT = Effect(
    id="quadratic_drag",
    family="drag",
    explanation="a fluid at rest brakes the tube with the square of its speed",
    law="force per length = coefficient |v| v, v the velocity vector across the tube",
    source="J.R. Morison et al. (1950), drag term",
    parameters=(
        Parameter(
            "coefficient",
            "N s^2/m^3",
            0.02,
            100.0,
            0.0,
            per="drag",
            gain_power=-1.0,
            meaning="drag per length of tube",
        ),
    ),
    apply=apply,
    below_contact=True,
    broken=("T1", "T2", "T5"),
    aliases=("modal_damping",),
    locations=lambda values: ["tube"] if values["structure"]["kind"] in places.TUBES else [],
)
