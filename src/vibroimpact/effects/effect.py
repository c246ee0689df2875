"""What an effect of the catalogue is: a change of a configuration, with parameters that have units,
bounds and a neutral value.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

# What each invariance test is broken by; see docs/method.md.
TESTS = {
    "T1": "linearity below contact",
    "T2": "scaling with load over gap",
    "T3": "parity",
    "T4": "mirror",
    "T5": "power balance",
    "T6": "stationarity",
}


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect.

    unit; low, high: bounds in units of the scale named `per` (a key of scales.scales, "one" for SI
    as it is); neutral: value without the effect in SI, None where the effect has no neutral limit;
    log: searched in its logarithm; design: values to try first, as fractions from low (0) to high
    (1) of the searched range; over: the parameter that this one is searched as a multiple of (the
    range is that of a value of 1 in its scale), where the two together set what is seen;
    gain_power: with which power of a gain common to force and responses the value that explains the
    records grows: such a gain is a length scaled and can not be told from one.
    """

    name: str
    unit: str
    low: float
    high: float
    neutral: float | None
    per: str = "one"
    log: bool = True
    design: tuple[float, ...] = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
    over: str | None = None
    gain_power: float = 0.0


@dataclass(frozen=True)
class Effect:
    """An entry of the catalogue.

    apply(values, parameters, location) -> values: values are a configuration in plain values
    (Config.model_dump), which are not changed; parameters {name: value in SI}. locations(values) ->
    names of the places that the effect may sit at. broken: the invariances it breaks; aliases: ids
    of effects that look alike; source: where the law is from; linear: it acts in the linear
    structure below contact too, and keeps it linear; below_contact: it is not linear, yet acts
    where nothing touches, and may be taken for a linear effect there; measured: it changes what was
    measured, not the model (see measurement.py); needs: what the campaign must hold; law_of: id of
    the effect of the catalogue that it is another law of, under which it is reported; quantity:
    what several effects of the catalogue are laws of; other_laws: what may stand in the place of
    apply, the same effect by laws that differ from it in what no measurement of a structure in use
    tells; unlimited(values, location) -> (id, location) of the effect that it is where its limit is
    never reached, None where the catalogue has none.
    """

    id: str
    explanation: str
    source: str
    parameters: tuple[Parameter, ...]
    apply: Callable = None
    locations: Callable = field(default=lambda values: ["all"])
    broken: tuple[str, ...] = ()
    aliases: tuple[str, ...] = ()
    linear: bool = False
    below_contact: bool = False
    measured: bool = False
    needs: tuple[str, ...] = ()
    law_of: str = ""
    other_laws: tuple[Callable, ...] = ()
    quantity: str = ""
    unlimited: Callable = field(default=lambda values, location: None)

    @property
    def reported(self):
        """Return the id under which the effect is reported."""
        return self.law_of or self.id

    def neutral(self):
        """Return {name: neutral value}; None when a parameter has none."""
        values = {parameter.name: parameter.neutral for parameter in self.parameters}
        return None if None in values.values() else values
