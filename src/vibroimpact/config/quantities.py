"""The quantities that a configuration may hold: each with its range and the remedy when a value is
outside.
"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
)
from pydantic_core import PydanticCustomError


class Section(BaseModel):
    """A block of keys: immutable, and a key that is not declared is an error."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, protected_namespaces=()
    )


def _refuse_bool(value: Any) -> Any:
    """The value itself; YAML's `yes` and `true` would otherwise pass as the number 1."""
    if isinstance(value, bool):
        raise PydanticCustomError("number", "must be a number, not yes/no")
    return value


Number = Annotated[float, BeforeValidator(_refuse_bool)]
Whole = Annotated[int, BeforeValidator(_refuse_bool)]


def within(
    remedy: str,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    below: float | None = None,
) -> AfterValidator:
    """A validator for `above < value`, `at_least <= value <= at_most`, `value < below`; its message
    ends with the remedy.
    """
    bounds = [
        (above, ">", lambda value, bound: value > bound),
        (at_least, ">=", lambda value, bound: value >= bound),
        (at_most, "<=", lambda value, bound: value <= bound),
        (below, "<", lambda value, bound: value < bound),
    ]

    def check(value: float) -> float:
        for bound, sign, holds in bounds:
            if bound is not None and not holds(value, bound):
                raise PydanticCustomError(
                    "range",
                    "must be {rule}: {remedy}",
                    {"rule": f"{sign} {bound:g}", "remedy": remedy},
                )
        return value

    return AfterValidator(check)


Diameter_m = Annotated[Number, within("in metres? 22.22 mm is 0.02222", above=0, at_most=2)]
Wall_m = Annotated[Number, within("in metres? 1.27 mm is 0.00127", above=0, at_most=1)]
Length_m = Annotated[Number, within("give the length in metres", above=0, at_most=1000)]
Height_m = Annotated[Number, within("in metres? 30 mm is 0.030", above=0, at_most=5)]
Gap_m = Annotated[Number, within("give the radial clearance in metres", above=0)]
Youngs_modulus_Pa = Annotated[
    Number, within("in Pa? 202 GPa is 2.02e11", at_least=1e6, at_most=1e13)
]
Stress_Pa = Annotated[Number, within("in Pa? 240 MPa is 240.0e6", at_least=1e4)]
Poisson_ratio = Annotated[Number, within("0.3 for most metals", at_least=0, below=0.5)]
Density = Annotated[Number, within("in kg/m3? 8.33 g/cm3 is 8330", at_least=10, at_most=3e4)]
Shear_coefficient = Annotated[
    Number, within("the effective part of the section: 0.53 for a thin tube", above=0, at_most=1)
]
Stiffness = Annotated[Number, within("give the stiffness in N/m", above=0)]
Rotation_stiffness = Annotated[Number, within("give the stiffness in N m/rad", above=0)]
Positive_factor = Annotated[Number, within("give a positive factor", above=0)]
Coefficient = Annotated[Number, within("a damping coefficient is not negative", at_least=0)]
Damping_ratio = Annotated[
    Number, within("a fraction, not per cent: 1.5 % is 0.015", at_least=0, below=0.3)
]
Force_N = Annotated[Number, within("give the force in newtons RMS", above=0, at_most=1e6)]
Frequency_Hz = Annotated[Number, within("give the frequency in Hz", above=0, at_most=1e7)]
Lowest_frequency_Hz = Annotated[Number, within("give the frequency in Hz", at_least=0, at_most=1e7)]
Duration_s = Annotated[Number, within("give the duration in seconds", above=0, at_most=1e5)]
Start_up_s = Annotated[
    Number, within("give the duration in seconds, 0 for none", at_least=0, at_most=1e5)
]
Fraction_of_gap = Annotated[
    Number, within("a small fraction of the gap: 1.0e-6", at_least=0, at_most=0.1)
]
Overlap = Annotated[
    Number, within("a fraction, not per cent: 65 % is 0.65", at_least=0, at_most=0.95)
]
Angle_deg = Annotated[Number, within("in degrees: half a turn is 180", above=0, at_most=360)]


def count(at_least: int, at_most: int, remedy: str) -> Any:
    """The type of a whole number between two bounds."""
    return Annotated[Whole, within(remedy, at_least=at_least, at_most=at_most)]


def row(element: Any, length: int, remedy: str) -> Any:
    """The type of a list of `length` elements; its message for another length ends with the
    remedy.
    """

    def check(value: tuple) -> tuple:
        if len(value) != length:
            raise PydanticCustomError(
                "length", "has {count} values: {remedy}", {"count": len(value), "remedy": remedy}
            )
        return value

    return Annotated[tuple[element, ...], AfterValidator(check)]


def named(pattern: str, remedy: str) -> Any:
    """The type of a text that matches a pattern; its message says what is allowed."""

    def check(value: str) -> str:
        if not re.fullmatch(pattern, value):
            raise PydanticCustomError("name", "must be {remedy}", {"remedy": remedy})
        return value

    return Annotated[str, AfterValidator(check)]


Name = named("[A-Za-z][A-Za-z0-9_]*", "a name of letters, digits and _ that begins with a letter")
Study_name = named("[A-Za-z0-9][A-Za-z0-9_-]*", "a folder name of letters, digits, _ and -")
Vector = row(Number, 3, "give three, along x, y and z")
Pair = row(Number, 2, "give two, along the support's transverse directions")
Band_Hz = row(Lowest_frequency_Hz, 2, "give two, the lower end and the upper end in Hz")
Stiffness_range = row(Stiffness, 2, "give two, the lowest and the highest stiffness in N/m")
Axis = Literal["x", "y", "z"]


def one_or_list(one: Any, many: Any, depth: int = 1) -> Any:
    """The type of a key that takes one value, or a list of them (one per contact point).

    depth: how many lists one value consists of already: 1 for a number, 2 for a pair of numbers.
    """

    def shape(value: Any) -> str:
        for _ in range(depth - 1):
            value = value[0] if isinstance(value, (list, tuple)) and value else None
        return "list" if isinstance(value, (list, tuple)) else "one"

    return Annotated[
        Annotated[one, Tag("one")] | Annotated[many, Tag("list")], Discriminator(shape)
    ]


def choice(*sections: Any) -> Any:
    """The type of a section whose key `kind` says which keys it has."""
    union = sections[0]
    for section in sections[1:]:
        union = union | section
    return Annotated[union, Field(discriminator="kind")]
