"""The types of configuration values: each has its range, its unit if the key's name does not
end with it, and a remedy for values out of range.
"""

import operator
import re
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Tag,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

LARGEST = 1e20
SHORTEST = 1e-9  # length of a direction, any unit
NOT_GIVEN = "not_given"  # type of the error of a key that another key makes necessary


class Section(BaseModel):
    """A block of keys. It is immutable, and a key that is not declared is an error."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, protected_namespaces=()
    )


def _refuse_bool(value: Any) -> Any:
    """Return the value; a bool, which pydantic would take for 0 or 1, is an error."""
    if isinstance(value, bool):
        raise PydanticCustomError("number", "must be a number, not yes/no")
    return value


def _refuse_huge(value: float) -> float:
    """Return the value; one that no quantity in SI units reaches is an error."""
    if abs(value) > LARGEST:
        raise PydanticCustomError("number", "is beyond any quantity in SI units: check its power")
    return value


Number = Annotated[float, BeforeValidator(_refuse_bool), AfterValidator(_refuse_huge)]
Whole = Annotated[int, BeforeValidator(_refuse_bool)]


@dataclass(frozen=True)
class Unit:
    """The unit of a value whose key does not end with it; "1" for a number without unit."""

    symbol: str


@dataclass(frozen=True)
class Checked:
    """A check that runs after the type's own, and its addition to the JSON schema."""

    remedy: str

    def fault(self, value: Any) -> str | None:
        """Return what is wrong with a value, with the remedy; None if nothing is."""
        raise NotImplementedError

    def json_keywords(self) -> dict[str, Any]:
        """Return the JSON schema keywords that state the same as the check, if there are any."""
        return {}

    def check(self, value: Any) -> Any:
        """Return the value. Raises PydanticCustomError with the fault."""
        if fault := self.fault(value):
            raise PydanticCustomError("rule", "{fault}", {"fault": fault})
        return value

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Return the core schema with the check after the type's own."""
        return core_schema.no_info_after_validator_function(self.check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Return the JSON schema of the type with the keywords of the check."""
        return {**handler(schema), **self.json_keywords()}


class Bound(NamedTuple):
    """A kind of bound: how a sentence, a table and JSON schema write it, and what holds."""

    sign: str
    shown: str
    keyword: str
    holds: Callable[[float, float], bool]


BOUNDS = {  # key of a Range
    "above": Bound(">", ">", "exclusiveMinimum", operator.gt),
    "at_least": Bound(">=", "≥", "minimum", operator.ge),
    "at_most": Bound("<=", "≤", "maximum", operator.le),
    "below": Bound("<", "<", "exclusiveMaximum", operator.lt),
}


@dataclass(frozen=True)
class Range(Checked):
    """Bounds of a number: above < value, at_least <= value <= at_most, value < below."""

    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    below: float | None = None

    def bounds(self) -> list[tuple[Bound, float]]:
        """Return [(kind, number)] of the bounds there are."""
        given = [(kind, getattr(self, key)) for key, kind in BOUNDS.items()]
        return [(kind, bound) for kind, bound in given if bound is not None]

    def fault(self, value: float) -> str | None:
        """Return which bound a number breaks."""
        broken = (each for each in self.bounds() if not each[0].holds(value, each[1]))
        return next((f"must be {kind.sign} {n:g}: {self.remedy}" for kind, n in broken), None)

    def json_keywords(self) -> dict[str, Any]:
        """Return minimum, maximum and their exclusive forms."""
        return {kind.keyword: bound for kind, bound in self.bounds()}


@dataclass(frozen=True)
class Length(Checked):
    """The number of values of a list."""

    count: int

    def fault(self, value: tuple) -> str | None:
        """Return that a list has another length."""
        return None if len(value) == self.count else f"has {len(value)} values: {self.remedy}"

    def json_keywords(self) -> dict[str, Any]:
        """Return minItems and maxItems."""
        return {"minItems": self.count, "maxItems": self.count}


@dataclass(frozen=True)
class Pattern(Checked):
    """A regular expression that the whole text matches; the remedy states the allowed texts."""

    expression: str

    def fault(self, value: str) -> str | None:
        """Return that a text does not match."""
        return None if re.fullmatch(self.expression, value) else f"must be {self.remedy}"

    def json_keywords(self) -> dict[str, Any]:
        """Return the pattern."""
        return {"pattern": f"^(?:{self.expression})$"}


@dataclass(frozen=True)
class NotZero(Checked):
    """The components of a direction, of which one at least is not 0."""

    def fault(self, value: tuple) -> str | None:
        """Return that a direction has no length."""
        still = all(abs(component) < SHORTEST for component in value)
        return f"is not a direction: {self.remedy}" if still else None

    def json_keywords(self) -> dict[str, Any]:
        """Return that not all items are 0."""
        return {"not": {"items": {"const": 0}}}


@dataclass(frozen=True)
class Ascending(Checked):
    """Numbers of which each is above the one before; a JSON schema can not compare them."""

    def fault(self, value: tuple) -> str | None:
        """Return that numbers are in another order."""
        falls = any(after <= before for before, after in pairwise(value))
        return f"is not in ascending order: {self.remedy}" if falls else None


Diameter_m = Annotated[Number, Range("in metres? 22.22 mm is 0.02222", above=0, at_most=2)]
Wall_m = Annotated[Number, Range("in metres? 1.27 mm is 0.00127", above=0, at_most=1)]
Length_m = Annotated[Number, Range("give the length in metres", above=0, at_most=1000)]
Youngs_modulus_Pa = Annotated[
    Number, Range("in Pa? 202 GPa is 2.02e11", at_least=1e6, at_most=1e13)
]
Poisson_ratio = Annotated[Number, Range("0.3 for most metals", at_least=0, below=0.5), Unit("1")]
Density = Annotated[Number, Range("in kg/m3? 8.33 g/cm3 is 8330", at_least=10, at_most=3e4)]
Shear_coefficient = Annotated[
    Number,
    Range("the effective part of the section: 0.53 for a thin tube", above=0, at_most=1),
    Unit("1"),
]
Area_m2 = Annotated[Number, Range("in m2? 100 mm2 is 1.0e-4", above=0, at_most=4)]
Second_moment = Annotated[Number, Range("in m4? 1 cm4 is 1.0e-8", above=0, at_most=1)]
Temperature_C = Annotated[Number, Range("in degrees Celsius", at_least=-273.15, at_most=3000)]
Stiffness = Annotated[Number, Range("give the stiffness in N/m", above=0, at_most=1e15)]
Mass_kg = Annotated[Number, Range("give the mass in kg", above=0, at_most=1e9)]
Positive_factor = Annotated[
    Number, Range("give a positive factor", above=0, at_most=1e6), Unit("1")
]
Coefficient = Annotated[Number, Range("a damping coefficient is not negative", at_least=0)]
Non_negative = Annotated[Number, Range("give 0 for none", at_least=0)]
Damping_ratio = Annotated[
    Number, Range("a fraction, not per cent: 1.5 % is 0.015", at_least=0, below=0.3), Unit("1")
]
Frequency_Hz = Annotated[Number, Range("give the frequency in Hz", above=0, at_most=1e7)]
Lowest_frequency_Hz = Annotated[Number, Range("give the frequency in Hz", at_least=0, at_most=1e7)]
Phase_deg = Annotated[Number, Range("in degrees, between -360 and 360", at_least=-360, at_most=360)]

Name = Annotated[
    str,
    Pattern("a name of letters, digits and _ that begins with a letter", "[A-Za-z][A-Za-z0-9_]*"),
]
Axis = Literal["x", "y", "z"]
Vector = Annotated[tuple[Number, ...], Length("give three, along x, y and z", 3)]
Direction = Annotated[Vector, NotZero("give three components that are not all 0"), Unit("1")]
Position = Annotated[Vector, Unit("m")]
Pair = Annotated[
    tuple[Number, ...], Length("give two, along the support's transverse directions", 2)
]
Two_axes = Length("give two, of the section's first and second axis", 2)
Band_Hz = Annotated[
    tuple[Lowest_frequency_Hz, ...],
    Length("give two, the lower end and the upper end in Hz", 2),
    Ascending("give the lower end first"),
]
Not_empty = Field(min_length=1)
By_kind = Field(discriminator="kind")


def _shape_at(depth: int) -> Callable[[Any], str]:
    """Return the function that says whether a value, inside `depth` lists, is "one" or a "list"."""

    def shape(value: Any) -> str:
        for _ in range(depth):
            value = value[0] if isinstance(value, (list, tuple)) and value else None
        return "list" if isinstance(value, (list, tuple)) else "one"

    return shape


# A key that takes one value or a list of them is One_or_more[X]; with other lists, One_or[X, Y].
One, List = Tag("one"), Tag("list")
X = TypeVar("X")
Y = TypeVar("Y")
One_or = Annotated[Annotated[X, One] | Annotated[Y, List], Discriminator(_shape_at(0))]
One_or_more = One_or[X, tuple[X, ...]]
One_or_list_of_pairs = Discriminator(_shape_at(1))
