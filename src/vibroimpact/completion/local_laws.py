"""The local laws that a completion tries, by the ids of the catalogue: their parameters, where a
search starts, and the kernel's columns.

All are written as a change of the identified linear structure: at vanishing amplitude the elastic
ones leave it as it is (a slider that sticks, a saturation below its limit), so that the modes
identified at the lowest level stay nearly those of the completed model.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

COULOMB_LIMITS = 4  # sliders in parallel stand for a distribution of limits (Iwan)
# the limits' displacements: from this times the RMS at the lowest level to this times that at the
# highest
SPREAD = (
    0.7,
    4.0,
)


@dataclass(frozen=True)
class Scales:
    """Sizes that a search starts from: stiffness N/m (largest change seen), low and high RMS
    relative displacement m, omega rad/s.
    """

    stiffness: float
    low: float
    high: float
    omega: float


@dataclass(frozen=True)
class Parameter:
    """name, unit, and whether it is positive (searched by its logarithm)."""

    name: str
    unit: str
    positive: bool = True


@dataclass(frozen=True)
class LocalLaw:
    """id of the catalogue; what it is, in words; parameters; columns(values) -> {column of
    LocalLaws: (element,)}; starts(Scales) -> list of values (parameter,); summary(values) -> {name:
    (value, unit)} of what is told, from the values; count of elements.
    """

    id: str
    words: str
    parameters: tuple
    columns: Callable
    starts: Callable
    summary: Callable
    elements: int = 1


def _told(*parameters):
    return lambda values: {
        each.name: (float(value), each.unit) for each, value in zip(parameters, values, strict=True)
    }


def _simple(identity, words, parameters, columns, starts):
    return LocalLaw(identity, words, parameters, columns, starts, _told(*parameters))


def _signed(size, factors=(0.03, 0.3)):
    """Start values of a coefficient of either sign."""
    return [np.array([sign * factor * size]) for factor in factors for sign in (1.0, -1.0)]


def _pairs(first, second):
    return [np.array([one, other]) for one in first for other in second]


def _coulomb(count):
    """Sliders in parallel: values are their stick stiffnesses, then their slip displacements in
    m.
    """
    parameters = (
        *(Parameter(f"stick_stiffness_{n + 1}", "N/m") for n in range(count)),
        *(Parameter(f"slip_displacement_{n + 1}", "m") for n in range(count)),
    )

    def columns(values):
        stick, slip = values[:count], values[count:]
        return {"stiffness": -stick, "stick_stiffness": stick, "slip_limit": stick * slip}

    def starts(scales):
        middle = np.sqrt(scales.low * scales.high)
        slips = (
            [np.full(1, factor * middle) for factor in (0.5, 1.0, 2.0, 4.0)]
            if count == 1
            else [
                np.geomspace(low * scales.low, high * scales.high, count)
                for low, high in (SPREAD, (1.5, 2.5))
            ]
        )
        return [
            np.concatenate([np.full(count, factor * scales.stiffness / count), slip])
            for factor in (0.7, 1.5, 3.0)
            for slip in slips
        ]

    def summary(values):
        stick, slip = values[:count], values[count:]
        return {
            "force": (float(stick @ slip), "N"),
            "stick_stiffness": (float(stick.sum()), "N/m"),
            "slip_displacement": (float(stick @ slip / stick.sum()), "m"),
        }

    words = (
        "one slider on an elastic stick spring"
        if count == 1
        else f"{count} sliders of different limits on stick springs"
    )
    return LocalLaw(
        "coulomb_friction", f"dry friction: {words}", parameters, columns, starts, summary, count
    )


def _saturation_damping():
    """A damper that stops at the force it has at a speed, less the same damper without a limit: the
    damping falls beyond that speed, or rises where its coefficient is negative.
    """
    parameters = (Parameter("damping", "N s/m", False), Parameter("speed", "m/s"))

    def columns(values):
        damping, speed = values
        return {
            "damping": np.array([-damping, damping]),
            "damping_limit": np.array([0.0, abs(damping) * speed]),
        }

    def starts(scales):
        speeds = scales.omega * np.geomspace(scales.low, scales.high, 3)
        dampings = _signed(scales.stiffness / scales.omega, (0.1, 0.4))
        return [np.array([damping, speed]) for (damping,) in dampings for speed in speeds]

    words = "a damper whose force stops at a limit"
    return LocalLaw("saturation_damping", words, parameters, columns, starts, _told(*parameters), 2)


LAWS = {
    "cubic_stiffness": _simple(
        "cubic_stiffness",
        "a force with the third power of the displacement",
        (Parameter("cubic_stiffness", "N/m3", False),),
        lambda v: {"cubic": v},
        lambda s: _signed(s.stiffness / s.high**2),
    ),
    "quadratic_stiffness": _simple(
        "quadratic_stiffness",
        "a force with the square of the displacement",
        (Parameter("quadratic_stiffness", "N/m2", False),),
        lambda v: {"quadratic": v},
        lambda s: _signed(s.stiffness / s.high),
    ),
    "quadratic_drag": _simple(
        "quadratic_drag",
        "a drag with the square of the speed",
        (Parameter("drag", "N s2/m2"),),
        lambda v: {"drag": v},
        lambda s: [
            np.array([f * s.stiffness / (s.omega**2 * s.high)]) for f in (0.03, 0.1, 0.3, 1.0)
        ],
    ),
    "saturation_stiffness": _simple(
        "saturation_stiffness",
        "a spring whose force stops at a limit",
        (Parameter("stiffness", "N/m"), Parameter("limit", "N")),
        lambda v: {"stiffness": -v[:1], "saturation_stiffness": v[:1], "saturation_limit": v[1:]},
        lambda s: [
            np.array([k, k * w])
            for k in (0.5 * s.stiffness, 2.0 * s.stiffness)
            for w in (s.low, 0.5 * s.high, 2.0 * s.high)
        ],
    ),
    "saturation_damping": _saturation_damping(),
    "clearance": _simple(
        "clearance",
        "a stop behind a clearance",
        (Parameter("half_gap", "m"), Parameter("stiffness", "N/m")),
        lambda v: {
            "stiffness": v[1:],
            "saturation_stiffness": -v[1:],
            "saturation_limit": v[1:] * v[:1],
        },
        lambda s: _pairs((s.low, 0.5 * s.high, 1.5 * s.high), (0.1 * s.stiffness, s.stiffness)),
    ),
    "single_friction": _coulomb(1),
    "coulomb_friction": _coulomb(COULOMB_LIMITS),
    "few_frictions": _coulomb(3),
}
