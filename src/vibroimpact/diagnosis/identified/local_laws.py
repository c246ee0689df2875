"""The local laws that are fitted to an identified structure: parameters, start values, and the
columns of the kernel.

Each is a change of the linear structure that vanishes at vanishing amplitude (a slider that sticks,
a saturation below its limit), so that the modes of the lowest level stay nearly those of the
completed model. Their ids are those of the catalogue of effects, if it has them.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from vibroimpact.effects.registry import EFFECTS

SLIDERS = 4  # in parallel they stand for a distribution of limits (Iwan)
# Displacements at their limits: from a factor of the RMS at the lowest level to one at the highest.
SPREADS = ((0.7, 4.0), (1.5, 2.5))
Values = np.ndarray  # (parameter,)


@dataclass(frozen=True)
class Scales:
    """Sizes that a search starts from.

    stiffness: N/m, of the largest change seen. low, high: m, RMS relative displacement at the
    lowest and the highest level. omega: rad/s.
    """

    stiffness: float
    low: float
    high: float
    omega: float


@dataclass(frozen=True)
class LocalLaw:
    """A law at a place.

    id: of the catalogue. parameters {name: unit}. columns(values): {column of LocalLaws:
    (element,)}. starts(Scales): values that a fit starts from. signed: parameters of either sign;
    the others are searched in their logarithm. told(values): {name: (value, unit)}, if other
    quantities than the parameters are reported. elements: number of elements.
    """

    id: str
    parameters: dict[str, str]
    columns: Callable[[Values], dict[str, Values]]
    starts: Callable[[Scales], list[Values]]
    signed: tuple[str, ...] = ()
    told: Callable[[Values], dict[str, tuple[float, str]]] | None = None
    elements: int = 1

    @property
    def positive(self) -> np.ndarray:
        """Return (parameter,) bool."""
        return np.array([name not in self.signed for name in self.parameters])

    @property
    def broken(self) -> tuple[str, ...]:
        """Return the invariances that the effect breaks, as the catalogue says."""
        return EFFECTS[self.id].broken if self.id in EFFECTS else ()

    def summary(self, values: Values) -> dict[str, tuple[float, str]]:
        """Return {name: (value, unit)}, the reported quantities."""
        if self.told is not None:
            return self.told(values)
        pairs = zip(self.parameters.items(), values, strict=True)
        return {name: (float(value), unit) for (name, unit), value in pairs}


def _pairs(first: Iterable[float], second: Iterable[float]) -> list[Values]:
    """Return every pair of two lists of values."""
    return [np.array([one, other]) for one in first for other in second]


def _power(name: str, unit: str, column: str, power: int) -> LocalLaw:
    """Return the law of a force with a power of the displacement, its coefficient of either
    sign.
    """
    return LocalLaw(
        name,
        {name: unit},
        lambda v: {column: v},
        lambda s: [
            np.array([f * (s.stiffness / s.high ** (power - 1))]) for f in (0.03, -0.03, 0.3, -0.3)
        ],
        signed=(name,),
    )


def _sliders(count: int) -> LocalLaw:
    """Return sliders in parallel; values: their stick stiffnesses, then the displacements in m at
    which they slip.
    """
    parameters = {f"stick_stiffness_{number + 1}": "N/m" for number in range(count)}
    parameters |= {f"slip_displacement_{number + 1}": "m" for number in range(count)}

    def starts(scales: Scales) -> list[Values]:
        middle = np.sqrt(scales.low * scales.high)
        slips = [np.full(1, factor * middle) for factor in (0.5, 1.0, 2.0, 4.0)]
        if count > 1:
            slips = [np.geomspace(a * scales.low, b * scales.high, count) for a, b in SPREADS]
        return [
            np.concatenate([np.full(count, factor * scales.stiffness / count), slip])
            for factor in (0.7, 1.5, 3.0)
            for slip in slips
        ]

    def columns(values: Values) -> dict[str, Values]:
        stick, slip = values[:count], values[count:]
        return {"stiffness": -stick, "stick_stiffness": stick, "slip_limit": stick * slip}

    def told(values: Values) -> dict[str, tuple[float, str]]:
        stick, force = float(values[:count].sum()), float(values[:count] @ values[count:])
        names = ("force", force, "N"), ("stick_stiffness", stick, "N/m")
        told = (*names, ("slip_displacement", force / stick, "m"))
        return {name: (value, unit) for name, value, unit in told}

    return LocalLaw("coulomb_friction", parameters, columns, starts, told=told, elements=count)


LAWS = {
    "cubic_stiffness": _power("cubic_stiffness", "N/m3", "cubic", 3),
    "quadratic_stiffness": _power("quadratic_stiffness", "N/m2", "quadratic", 2),
    "quadratic_drag": LocalLaw(
        "quadratic_drag",
        {"drag": "N s2/m2"},
        lambda v: {"drag": v},
        lambda s: [
            np.array([f * s.stiffness / (s.omega**2 * s.high)]) for f in (0.03, 0.1, 0.3, 1.0)
        ],
    ),
    # a spring whose force stops at a limit
    "saturation_stiffness": LocalLaw(
        "saturation_stiffness",
        {"stiffness": "N/m", "limit": "N"},
        lambda v: {"stiffness": -v[:1], "saturation_stiffness": v[:1], "saturation_limit": v[1:]},
        lambda s: [
            np.array([k, k * w])
            for k in (0.5 * s.stiffness, 2.0 * s.stiffness)
            for w in (s.low, 0.5 * s.high, 2.0 * s.high)
        ],
    ),
    # a damper whose force stops at a limit, less the same damper without one: the damping falls
    # beyond that speed, or rises if the coefficient is negative
    "saturation_damping": LocalLaw(
        "saturation_damping",
        {"damping": "N s/m", "speed": "m/s"},
        lambda v: {
            "damping": np.array([-v[0], v[0]]),
            "damping_limit": np.array([0.0, abs(v[0]) * v[1]]),
        },
        lambda s: _pairs(
            np.outer((0.1, 0.4), (1.0, -1.0)).ravel() * s.stiffness / s.omega,
            s.omega * np.geomspace(s.low, s.high, 3),
        ),
        signed=("damping",),
        elements=2,
    ),
    # a stop behind a clearance
    "clearance": LocalLaw(
        "clearance",
        {"half_gap": "m", "stiffness": "N/m"},
        lambda v: {
            "stiffness": v[1:],
            "saturation_stiffness": -v[1:],
            "saturation_limit": v[1:] * v[:1],
        },
        lambda s: _pairs((s.low, 0.5 * s.high, 1.5 * s.high), (0.1 * s.stiffness, s.stiffness)),
    ),
    "single_friction": _sliders(1),
    "coulomb_friction": _sliders(SLIDERS),
    "few_frictions": _sliders(3),
}
