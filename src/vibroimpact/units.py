"""Units of measured channels: a UDUNITS text in, the factor to SI out; what can not be told is an
error with its remedy, never a guess.
"""

from __future__ import annotations

import re
from functools import cache

# Time derivatives of the displacement in what each kind of sensor measures.
TIME_DERIVATIVES = {"displacement": 0, "velocity": 1, "acceleration": 2}

SI_OF_KIND = {
    "acceleration": "m s-2",
    "velocity": "m s-1",
    "displacement": "m",
    "contact_force": "N",
    "force": "N",
    "voltage": "V",
}
EXAMPLES = {
    "acceleration": "m s-2, mm s-2, ft s-2 or g",
    "velocity": "m s-1 or mm s-1",
    "displacement": "m, mm or um",
    "contact_force": "N, kN or lbf",
    "force": "N, kN or lbf",
    "voltage": "V or mV",
}
# The texts that nearly every file holds: pint takes half a second to import, in each of hundreds of
# jobs.
COMMON = {
    "m s-2": ("acceleration", 1.0),
    "m/s2": ("acceleration", 1.0),
    "m/s^2": ("acceleration", 1.0),
    "m/s²": ("acceleration", 1.0),
    "m s-1": ("velocity", 1.0),
    "m/s": ("velocity", 1.0),
    "m": ("displacement", 1.0),
    "mm": ("displacement", 1e-3),
    "N": ("force", 1.0),
    "V": ("voltage", 1.0),
}
SAME = {"contact_force": "force"}  # kinds that share a dimension
ALIASES = {
    "gn": "standard_gravity",
    "g0": "standard_gravity",
    "g_0": "standard_gravity",
    "standard_free_fall": "standard_gravity",
    "mil": "thou",
    "mils": "thou",
}  # pint's mil is an angle
SHARE_OF_G = re.compile(r"(milli|m|µ|u)?[gG](?:'?s)?")
SCALED = re.compile(
    r"(\d+(?:\.\d*)?(?:[eE][+-]?\d+)?)\s+(\D.*)"
)  # a number before the unit, as in 0.001 m
PREFIX = {None: 1.0, "milli": 1e-3, "m": 1e-3, "µ": 1e-6, "u": 1e-6}
STANDARD_GRAVITY = 9.80665
WANTED_EXCITATION = (
    "force",
    "voltage",
)  # an input in volts is an excitation too, where no force was measured


class UnitError(Exception):
    """A unit that can not be used; the message is a sentence with its remedy."""


def si_factor(units: str, kind: str) -> float:
    """Return SI units per unit of a channel of some kind: multiply the values by it.

    units: UDUNITS text such as m s-2, mm/s², ft/s^2, g, lbf. kind: acceleration, velocity,
    displacement, contact_force, force, voltage; "generic" takes any unit; "excitation" takes forces
    and volts. For an acceleration "g" is standard gravity, not the gram. Raises UnitError for an
    empty or unknown unit, and for one of another dimension.
    """
    text = units.strip()
    if not text:
        raise UnitError(
            "has no unit: give one, such as"
            f" {EXAMPLES.get(kind, 'm s-2, mm, N or V; 1 for a number without a unit')}"
        )
    if text in COMMON and _fits(COMMON[text][0], kind):
        return COMMON[text][1]
    gravity = SHARE_OF_G.fullmatch(text) if kind == "acceleration" else None
    if gravity:
        return STANDARD_GRAVITY * PREFIX[gravity[1]]
    dimension, factor = _parsed(text)
    if kind == "generic" or any(dimension == _dimension_of(known) for known in _kinds(kind)):
        return factor
    hint = (
        " (that is a mass: write lbf or kgf for a force)"
        if dimension == _parsed("kg")[0] and "force" in (*_kinds(kind),)
        else ""
    )
    raise UnitError(
        f"has the unit '{text}', which is no {kind}{hint}: give a unit such as"
        f" {EXAMPLES.get(_kinds(kind)[0], 'N')}"
    )


def si_unit(units: str, kind: str) -> str:
    """Return the SI unit that si_factor leads to, as UDUNITS text. Raises UnitError as si_factor
    does.
    """
    si_factor(units, kind)
    if kind in SI_OF_KIND:
        return SI_OF_KIND[kind]
    for known in ("force", "voltage", "acceleration", "velocity", "displacement"):
        if (
            _fits(COMMON[units.strip()][0], known)
            if units.strip() in COMMON
            else _parsed(units.strip())[0] == _dimension_of(known)
        ):
            return SI_OF_KIND[known]
    base = (
        _registry()
        .Quantity(1.0, _translated(SCALED.sub(r"\2", units.strip())))
        .to_base_units()
        .units
    )
    return f"{base:~}".replace("**", "^") or "1"


def _kinds(kind):
    return WANTED_EXCITATION if kind == "excitation" else (SAME.get(kind, kind),)


def _fits(known, kind):
    return kind == "generic" or known in _kinds(kind)


@cache
def _registry():
    import pint

    return pint.UnitRegistry()


@cache
def _dimension_of(kind):
    return _parsed(SI_OF_KIND[kind])[0]


@cache
def _parsed(text):
    """Return (dimensionality, factor to SI base units) of a unit text. Raises UnitError."""
    import pint

    try:
        scale, unit_text = (
            (float(scaled[1]), scaled[2]) if (scaled := SCALED.fullmatch(text)) else (1.0, text)
        )
        unit = _registry().parse_units(_translated(unit_text))
        quantity = _registry().Quantity(1.0, unit).to_base_units()
    except (
        pint.errors.PintError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        SyntaxError,
        AssertionError,
    ) as error:
        raise UnitError(
            f"has the unit '{text}', which is not known: give a UDUNITS text such as m s-2, mm/s^2,"
            " g, mm, N, lbf or V"
        ) from error
    return unit.dimensionality, scale * float(quantity.magnitude)


def _translated(text):
    """Return a UDUNITS text in pint's way of writing: products as *, powers as **."""
    text = (
        ALIASES.get(text.strip(), text.strip())
        .replace("·", "*")
        .replace("⋅", "*")
        .replace("μ", "µ")
    )
    text = re.sub(r"(?<=[A-Za-zµ])\.(?=[A-Za-zµ])", "*", text)
    return re.sub(r"(?<=[A-Za-zµ])\s*(?:\^|\*\*)?\s*(-?\d+)", r"**\1", text)
