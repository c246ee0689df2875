"""The keys of a structure whose modes are identified from its own campaign."""

import re
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from .quantities import Section, Unit

ELSEWHERE = "elsewhere"  # stands for a place that no channel shows
PLACE_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,99}")
LAW_AT_PLACE = re.compile(r"[A-Za-z_]+\.[^\s/\\{}.][^\s/\\{}]{0,99}")  # the name of files


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _is_list(value: Any, holds: Callable[[Any], bool]) -> bool:
    return isinstance(value, list) and all(map(holds, value))


def _is_band(value: Any) -> bool:
    return _is_list(value, _is_number) and len(value) == 2 and 0.0 <= value[0] < value[1]


def _are_coefficients(value: Any) -> bool:
    return isinstance(value, dict) and all(map(_is_number, value.values())) and any(value.values())


def _are_names(value: Any) -> bool:
    return isinstance(value, list) and len(set(map(str, value))) == len(value)


def _is_flag(value: Any) -> bool:
    return isinstance(value, bool)


def only(holds: Callable[[Any], bool], rule: str) -> BeforeValidator:
    """A validator that refuses a value for which `holds` is false; its message is the rule."""

    def check(value: Any) -> Any:
        if not holds(value):
            raise PydanticCustomError("rule", "{rule}", {"rule": rule})
        return value

    return BeforeValidator(check)


Band = Annotated[
    tuple[float, float],
    only(_is_band, "must be two frequencies in Hz, the lower one first, as in [5, 60]"),
]
Channel_name = Annotated[
    str,
    only(
        lambda value: isinstance(value, str),
        "must be the name of a channel of the campaign, such as a1",
    ),
]
Place_name = Annotated[
    str,
    only(
        lambda value: PLACE_NAME.fullmatch(str(value)) is not None and value != ELSEWHERE,
        "must begin with a letter and hold letters, digits, _ and - only, and not be"
        f" '{ELSEWHERE}': it becomes the name of files",
    ),
]
Coefficients = Annotated[
    dict[str, Annotated[float, Unit("1")]],
    only(
        _are_coefficients,
        "must give a coefficient, not all 0, to each channel that counts, as in {a1: -1, a2: 1}",
    ),
]
Places = Annotated[
    dict[Place_name, Coefficients],
    only(
        lambda value: isinstance(value, dict) and bool(value),
        "must be a block of places, each with coefficients of channels, as in joint: {a1: -1, a2:"
        " 1}",
    ),
]
Law_at_place = Annotated[
    str,
    only(
        lambda value: isinstance(value, str) and LAW_AT_PLACE.fullmatch(value) is not None,
        "must be a law and a place with a point between, as in cubic_stiffness.joint",
    ),
]
A_LIST = "must be a list of names law.place, each once, as in [cubic_stiffness.joint]"
Laws = Annotated[
    tuple[Law_at_place, ...], only(lambda value: _are_names(value) and bool(value), A_LIST)
]
Laws_or_none = Annotated[tuple[Law_at_place, ...], only(_are_names, A_LIST)]
Two_flags = Annotated[
    tuple[bool, bool],
    only(
        lambda value: _is_list(value, _is_flag) and len(value) == 2,
        "must be two of true and false, for modes below and above the band, as in [true, true]",
    ),
]
Flag = Annotated[bool, only(_is_flag, "must be true or false")]
Emphasis = Annotated[
    float,
    Unit("1"),
    only(
        lambda value: _is_number(value) and 0.0 <= value <= 2.0,
        "must be between 0 (all levels alike) and 2",
    ),
]


class MeasuredStructure(Section):
    """A structure whose modes are identified from its own campaign. Every key but `kind` may be
    left out: the records then decide.
    """

    kind: Literal["identified"] = Field(description="This kind of structure, without `modes`.")
    band_Hz: Band | None = Field(
        None,
        description="Band in which modes are identified and responses compared. Default: the"
        " excited lines, as far as there is a response.",
        examples=[[5, 60]],
    )
    drive: Channel_name | None = Field(
        None,
        description="Channel at the point of the force. Mode shapes are scaled by it. Default: the"
        " nearest channel along the force.",
        examples=["a1"],
    )
    places: Places | None = Field(
        None,
        description="Relative displacements at which a law may act, each a sum of channels with"
        " coefficients. Default: every pair of channels along one direction, and every channel"
        " against the ground.",
        examples=[{"joint": {"a1": -1, "a2": 1}}],
    )
    candidates: Laws | None = Field(
        None,
        description="Laws that are tried, each at a place: `law.place`. Laws: `cubic_stiffness`,"
        " `quadratic_stiffness`, `quadratic_drag`, `saturation_stiffness`, `clearance`,"
        " `single_friction`, `coulomb_friction` (sliders of several limits), `few_frictions` (three"
        " sliders), `saturation_damping` (a damper whose force stops at a limit). Default: all but"
        " the last two, at the place whose response changes with the level and at others that"
        " explain it nearly as well.",
        examples=[["cubic_stiffness.joint", "clearance.joint"]],
    )
    additions: Laws_or_none | None = Field(
        None,
        description="Laws that are added to the best candidate, one after the other as long as each"
        " explains more; an empty list"
        f" for none. The place `{ELSEWHERE}` stands for one that no channel shows. Default: four"
        " laws at the best place.",
        examples=[["quadratic_stiffness.joint"]],
    )
    residual_modes: Two_flags | None = Field(
        None,
        description="Whether a mode below and a mode above the band stand for those outside it."
        " Default: if they lower the error at the lowest level.",
        examples=[[True, True]],
    )
    mean: Flag = Field(
        False,
        description="Whether the mean of the response is compared as well. An even law shifts it.",
        examples=[True],
    )
    emphasis: Emphasis = Field(
        0.0,
        description="How much more a strong level counts in the fit than a weak one: its relative"
        " error is multiplied by the RMS of its response over that of the largest level, to this"
        " power. Between 0 (all levels alike) and 2.",
        examples=[1],
    )
