"""Units of measured channels: the factor from a UDUNITS text to SI.

A unit that is not certain raises an error that states the remedy; nothing is guessed.
"""

import math
import re
from functools import cache
from tokenize import TokenError
from typing import Any

# Order of the time derivative of displacement that each kind of sensor measures.
TIME_DERIVATIVES = {"displacement": 0, "velocity": 1, "acceleration": 2}

# Kind of a quantity -> (SI unit, examples of its units).
UNITS_OF_KIND = {
    "acceleration": ("m s-2", "m s-2, mm s-2, ft s-2 or g"),
    "velocity": ("m s-1", "m s-1 or mm s-1"),
    "displacement": ("m", "m, mm or um"),
    "contact_force": ("N", "N, kN or lbf"),
    "strain": ("1", "1, um/m or microstrain"),
    "force": ("N", "N, kN or lbf"),
    "base_acceleration": ("m s-2", "m s-2, mm s-2 or g"),
    "voltage": ("V", "V or mV"),
    "time": ("s", "s or ms"),
}
SI_OF_KIND = {kind: unit for kind, (unit, _) in UNITS_OF_KIND.items()}
ANY = ("", "m s-2, mm, N or V; 1 for a number without a unit")
# Texts that nearly every file holds. They save the import of pint, half a second per job.
COMMON = {
    **dict.fromkeys(("m s-2", "m/s2", "m/s^2", "m/s²"), ("acceleration", 1.0)),
    **dict.fromkeys(("m s-1", "m/s"), ("velocity", 1.0)),
    "m": ("displacement", 1.0),
    "mm": ("displacement", 1e-3),
    "N": ("force", 1.0),
    "V": ("voltage", 1.0),
}
SAME_DIMENSION = {"contact_force": "force", "base_acceleration": "acceleration"}
# Names of UDUNITS that pint lacks; its mil is an angle.
ALIASES = {
    **dict.fromkeys(("gn", "g0", "g_0", "standard_free_fall"), "standard_gravity"),
    **dict.fromkeys(("mil", "mils"), "thou"),
    "ips": "inch/second",
    "KN": "kN",
    "strain": "m/m",
    **dict.fromkeys(("microstrain", "µstrain", "ustrain"), "um/m"),
}
WORD = re.compile(r"[A-Za-z]{3,}")  # a name; shorter ones are symbols, in which m is not M
SHARE_OF_G = re.compile(r"(milli|m|µ|u)?[gG](?:'?s)?")
# A number before the unit, as in 0.001 m.
SCALED = re.compile(r"(\d+(?:\.\d*)?(?:[eE][+-]?\d+)?)\s+(\D.*)")
# Texts that no unit needs and that pint would evaluate or skip: a power of a number (9**9**9 takes
# minutes), a number in brackets, one of two digits, two superscripts, a comment.
NO_UNIT = re.compile(r"[#\x00-\x1f]|\d\s*(?:\^|\*\*)|\(\s*[+-]?\d|\d\d|[\d⁰¹²³⁴⁵⁶⁷⁸⁹][⁰¹²³⁴⁵⁶⁷⁸⁹]")
LONGEST = 60  # characters
PREFIX = {None: 1.0, "milli": 1e-3, "m": 1e-3, "µ": 1e-6, "u": 1e-6}
STANDARD_GRAVITY = 9.80665
# Without a measured force, an input in volts serves as the excitation.
EXCITATION_KINDS = ("force", "voltage")


class UnitError(Exception):
    """A unit that cannot be used; the message is a sentence with its remedy."""


def si_factor(units: str, kind: str) -> float:
    """Return SI units per unit of a channel: multiply its values by it.

    units: UDUNITS text such as m s-2, mm/s², ft/s^2, g, lbf.
    kind: acceleration, velocity, displacement, contact_force, strain, force, base_acceleration,
        voltage or time; "generic" takes any unit, "excitation" takes forces and volts.

    For an acceleration "g" is standard gravity, not the gram. Raises UnitError for an empty or
    unknown unit, for one of another dimension, and for one that is not a factor (degC, dB).
    """
    text = units.strip()
    if not text:
        raise UnitError(f"has no unit: give one, such as {UNITS_OF_KIND.get(kind, ANY)[1]}")
    if text in COMMON and _fits(COMMON[text][0], kind):
        return COMMON[text][1]
    gravity = SHARE_OF_G.fullmatch(text) if "acceleration" in _kinds(kind) else None
    if gravity:
        return STANDARD_GRAVITY * PREFIX[gravity[1]]
    dimension, factor = _parsed(_spelled(text))
    if kind == "generic" or any(dimension == _dimension_of(known) for known in _kinds(kind)):
        return factor
    hint = (
        " (that is a mass: write lbf or kgf for a force)"
        if dimension == _parsed("kg")[0] and "force" in (*_kinds(kind),)
        else ""
    )
    raise UnitError(
        f"has the unit '{text}', which is no {kind}{hint}: give a unit such as"
        f" {UNITS_OF_KIND[_kinds(kind)[0]][1]}"
    )


def si_unit(units: str, kind: str) -> str:
    """Return the SI unit that si_factor leads to, as UDUNITS text. Raises UnitError."""
    si_factor(units, kind)
    if kind in SI_OF_KIND:
        return SI_OF_KIND[kind]
    for known in ("force", "voltage", "acceleration", "velocity", "displacement"):
        if units.strip() in COMMON:
            same = _fits(COMMON[units.strip()][0], known)
        else:
            same = _parsed(_spelled(units.strip()))[0] == _dimension_of(known)
        if same:
            return SI_OF_KIND[known]
    text = _translated(SCALED.sub(r"\2", _spelled(units.strip())))
    base = _registry().Quantity(1.0, text).to_base_units().units
    return f"{base:~}".replace("**", "^") or "1"


def _kinds(kind: str) -> tuple[str, ...]:
    if kind == "excitation":
        return EXCITATION_KINDS
    return (SAME_DIMENSION.get(kind, kind),)


def _fits(known: str, kind: str) -> bool:
    return kind == "generic" or known in _kinds(kind)


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


@cache
def _dimension_of(kind: str) -> Any:
    return _parsed(SI_OF_KIND[kind])[0]


def _spelled(text: str) -> str:
    """Return a unit text as pint spells it: names that it does not know in small letters."""
    small = WORD.sub(lambda word: word[0].lower(), text)
    for spelling in (text, small) if small != text else ():
        try:
            _parsed(spelling)
        except UnitError:
            continue
        return spelling
    return text


@cache
def _parsed(text: str) -> tuple[Any, float]:
    """Return (dimensionality, factor to SI base units) of a unit text. Raises UnitError."""
    import pint

    unknown = UnitError(
        f"has the unit '{text[:LONGEST]}', which is not known: give a UDUNITS text such as m s-2,"
        " mm/s^2, g, mm, N, lbf or V"
    )
    try:
        scaled = SCALED.fullmatch(text)
        scale, unit_text = (float(scaled[1]), scaled[2]) if scaled else (1.0, text)
        if len(text) > LONGEST or NO_UNIT.search(unit_text):
            raise unknown
        unit = _registry().parse_units(_translated(unit_text))
        origin, quantity = (
            _registry().Quantity(value, unit).to_base_units() for value in (0.0, 1.0)
        )
    except (
        pint.errors.PintError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        SyntaxError,
        AssertionError,
        ArithmeticError,
        TokenError,
    ) as error:
        raise unknown from error
    factor = scale * float(quantity.magnitude)
    if float(origin.magnitude) != 0.0 or not 0.0 < factor < math.inf:
        raise UnitError(
            f"has the unit '{text}', which is no multiple of an SI unit: convert the values to one"
            " such as K, Pa or m s-2"
        )
    return unit.dimensionality, factor


def _translated(text: str) -> str:
    """Return a UDUNITS text in pint's notation: products as *, powers as **."""
    text = text.replace("·", "*").replace("⋅", "*").replace("μ", "µ").strip()
    text = ALIASES.get(text, text)
    text = re.sub(r"(?<=[A-Za-zµ])\.(?=[A-Za-zµ])", "*", text)
    return re.sub(r"(?<=[A-Za-zµ])\s*(?:\^|\*\*)?\s*(-?\d+)", r"**\1", text)
