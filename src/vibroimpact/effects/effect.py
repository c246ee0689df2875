"""An effect of the catalogue: a change of a configuration, with parameters that have units,
bounds and a neutral value.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

Values = dict[str, Any]  # a configuration in plain values, as Config.model_dump gives it
Apply = Callable[[Values, dict[str, float], str], Values]

# Invariances of the bare model, which an effect may break; see docs/method.md.
TESTS = {
    "T1": "the linear response below contact",
    "T2": "scaling with load over gap",
    "T3": "parity",
    "T4": "mirror",
    "T5": "power balance",
    "T6": "stationarity",
}

# Units of the bounds of a parameter; diagnosis.sizes computes the sizes.
SCALES = {
    "one": "1",
    "gap": "the largest nominal clearance",
    "load": "the largest RMS force",
    "displacement": "the RMS displacement of the drive point at the highest load",
    "contact_stiffness": "the stiffness of the support in the model",
    "hertz": "the Hertz coefficient as stiff as the model's contact",
    "gap_force": "the force that closes the clearance",
    "mass": "the modal mass of the first mode at the drive point",
    "mass_per_length": "that modal mass over the length of the structure",
    "searched_length": "the searched part of the tube",
    "tube_translation": "the static stiffness at the drive point",
    "tube_rotation": "that stiffness times a hundredth of the squared length",
    "tube_damping": "the modal damping constant of the first mode at the drive point",
    "damping_per_length": "that damping constant over the length of the structure",
    "cubic": "the static stiffness over the squared RMS displacement",
    "quadratic": "the static stiffness over the RMS displacement",
    "slowness": "one over the speed of the lowest mode with the clearance as its amplitude",
    "drag": "the damping constant over length and RMS velocity of the drive point",
}
WHERE = ("contact", "nonlinear structure", "linear structure", "measurement")
# Groups of laws that act alike on a structure.
FAMILIES = (
    "friction",
    "contact stiffness",
    "contact damping",
    "clearance and position",
    "shape of the hole",
    "spring",
    "mass",
    "damping",
    "drag",
    "force",
    "sensor",
)


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect.

    meaning: its description in words.
    low, high: bounds, as multiples of the size that `per` names in SCALES.
    neutral: value in SI at which the effect vanishes, None if there is no such value.
    log: whether it is searched in its logarithm.
    over: another parameter of the effect; this one is searched as a multiple of it, if their
        ratio sets the response.
    gain_power: a gain common to force and responses scales lengths; the value that explains the
        records grows with this power of it.
    """

    name: str
    unit: str
    low: float
    high: float
    neutral: float | None
    per: str = "one"
    log: bool = True
    over: str | None = None
    gain_power: float = 0.0
    meaning: str = ""


@dataclass(frozen=True)
class Effect:
    """An entry of the catalogue.

    family: one of FAMILIES.
    explanation: its description in a clause.
    law: its equation, or the equation in words; p: indentation of a contact, u: displacement.
    source: the origin of the law.
    apply(values, parameters, location): the configuration with the effect; values are not changed;
        parameters {name: value in SI}; None if the effect acts on the measurement.
    locations(values): names of the places at which the effect may act.
    broken: keys of TESTS, the invariances that the effect breaks.
    aliases: ids of effects with a similar signature.
    linear: it changes the linear structure, also below contact.
    below_contact: it is nonlinear and acts without contact, so that it resembles a linear effect.
    measured: it changes the measurement, not the model.
    needs: quantity that the campaign must hold: "force" at a point of the structure, "voltage".
    called: its name if that is not the words of its id.
    law_of: id of the effect under which this one is reported, if it is another law of it.
    """

    id: str
    family: str
    explanation: str
    source: str
    parameters: tuple[Parameter, ...]
    law: str = ""
    apply: Apply | None = None
    locations: Callable[[Values], list[str]] = field(default=lambda values: ["all"])
    broken: tuple[str, ...] = ()
    aliases: tuple[str, ...] = ()
    linear: bool = False
    below_contact: bool = False
    measured: bool = False
    needs: tuple[str, ...] = ()
    called: str = ""
    law_of: str = ""

    @property
    def name(self) -> str:
        """Return the name in words: Hunt-Crossley damping."""
        return self.called or self.id.replace("_", " ")

    @property
    def acts_on(self) -> str:
        """Return the part that the effect acts on, one of WHERE."""
        if self.measured:
            return "measurement"
        if self.linear:
            return "linear structure"
        return "nonlinear structure" if self.below_contact else "contact"

    @property
    def reported(self) -> str:
        """Return the id under which the effect is reported."""
        return self.law_of or self.id

    def neutral(self) -> dict[str, float] | None:
        """Return {name: neutral value}; None when a parameter has none."""
        values = {
            parameter.name: parameter.neutral
            for parameter in self.parameters
            if parameter.neutral is not None
        }
        return values if len(values) == len(self.parameters) else None
