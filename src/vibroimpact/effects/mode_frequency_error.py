"""A mode whose frequency is not the computed one."""

from .effect import Effect, Parameter, Values


def apply(values: Values, parameters: dict[str, float], location: str) -> Values:
    """Return the configuration with the frequency of mode_<n> multiplied by a factor."""
    mode = int(location.removeprefix("mode_"))
    factors = [*values["mode_frequency_factors"]]
    factors += [1.0] * (mode - len(factors))
    factors[mode - 1] *= parameters["factor"]
    return values | {"mode_frequency_factors": factors}


EFFECT = Effect(
    id="mode_frequency_error",
    called="other frequency of a mode",
    family="mass",
    explanation="a mode has another frequency than computed",
    law="frequency of one mode = factor times the computed one",
    source="model error of the linear structure",
    parameters=(
        Parameter("factor", "1", 0.7, 1.4, 1.0, meaning="frequency over the computed one"),
    ),
    apply=apply,
    linear=True,
    broken=("T1",),
    aliases=("added_mass", "root_stiffness"),
    locations=lambda values: [f"mode_{mode}" for mode in range(1, 9)],
)
