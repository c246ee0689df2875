"""The facts that the declaration of a key states, in words."""

import json
from dataclasses import dataclass
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from .quantities import Length, Pattern, Range, Section, Unit

# Ending of a key -> its unit.
UNITS = {
    "_m": "m",
    "_s": "s",
    "_Hz": "Hz",
    "_N": "N",
    "_Pa": "Pa",
    "_kg": "kg",
    "_deg": "deg",
    "_C": "°C",
    "_m2": "m²",
    "_m4": "m⁴",
    "_Pa_s": "Pa s",
    "_per_s": "1/s",
    "_per_m": "1/m",
    "_s_per_m": "s/m",
    "_m_per_s": "m/s",
    "_N_per_m": "N/m",
    "_N_per_m2": "N/m²",
    "_N_per_m3": "N/m³",
    "_N_per_m15": "N/m^1.5",
    "_N_s_per_m": "N s/m",
    "_N_s2_per_m2": "N s²/m²",
    "_N_m_per_rad": "N m/rad",
    "_kg_per_m3": "kg/m³",
    "_per_second": "1/s",
}


@dataclass(frozen=True)
class DeclaredKey:
    """A key of a section.

    holds: its type, in words; unit: "" for no number, "1" for a number without unit;
    range: such as "> 0, ≤ 2"; default: as YAML writes it, None if the key is required; sections:
    the sections that its value consists of.
    """

    name: str
    holds: str
    unit: str
    range: str
    default: str | None
    meaning: str
    example: str
    sections: tuple[type[Section], ...]


def meaning_of(section: type[Section]) -> str:
    """Return the docstring of a section, each paragraph in one line."""
    paragraphs = (section.__doc__ or "").split("\n\n")
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)


def unit_of(name: str, field: FieldInfo) -> str:
    """Return the unit of a key: stated by its type, else by the ending of its name; "1" for whole
    numbers, "" for other types.

    Raises ValueError for a number whose unit is stated nowhere.
    """
    held = members(annotation_of(field))
    if not {float, int} & set(held):
        return ""
    stated = [each for each in _metadata(annotation_of(field)) if isinstance(each, Unit)]
    if stated:
        return stated[-1].symbol
    endings = [ending for ending in UNITS if name.endswith(ending)]
    if endings:
        return UNITS[max(endings, key=len)]
    if float in held:
        raise ValueError(f"key '{name}': state its unit in its name or with Unit in its type")
    return "1"


def members(annotation: Any) -> list:
    """Return the classes found anywhere inside a type such as tuple[Annotated[A | B, ...], ...]."""
    inner = [member for argument in get_args(annotation) for member in members(argument)]
    return inner or [annotation]


def sections_in(annotation: Any) -> tuple[type[Section], ...]:
    """Return the sections that a value of a type consists of."""
    return tuple(
        member
        for member in members(annotation)
        if isinstance(member, type) and issubclass(member, Section)
    )


def kind_of(member: Any) -> str | None:
    """Return the value of `kind` that selects a section among its alternatives, None without."""
    field = getattr(member, "model_fields", {}).get("kind")
    return get_args(field.annotation)[0] if field else None


def declared(name: str, field: FieldInfo) -> DeclaredKey:
    """Return the DeclaredKey of a field."""
    annotation = annotation_of(field)
    sections = sections_in(annotation)
    return DeclaredKey(
        name=name,
        holds=_in_words(annotation),
        unit=unit_of(name, field),
        range=_range(annotation),
        default=_default(field),
        meaning=field.description or "",
        example=", ".join(map(_written, examples_of(field))),
        sections=sections,
    )


def examples_of(field: FieldInfo) -> list:
    """Return the examples of a key: those stated, else its default, or the one value that it takes.

    A default that is empty or a section shows nothing.
    """
    default = field.get_default()
    if field.examples is not None:
        return field.examples
    if get_origin(field.annotation) is Literal and len(get_args(field.annotation)) == 1:
        return [*get_args(field.annotation)]
    shows = default not in (PydanticUndefined, None, ()) and not sections_in(field.annotation)
    return [default] if shows else []


def annotation_of(field: FieldInfo) -> Any:
    """Return the type of a field with the metadata that pydantic keeps apart from it."""
    extras = [*field.metadata] + ([field] if field.discriminator else [])
    return Annotated[(field.annotation, *extras)] if extras else field.annotation


def _metadata(annotation: Any) -> list[Any]:
    """Return the annotations that Annotated adds anywhere inside a type, from the inside out."""
    if get_origin(annotation) is Annotated:
        inner, *own = get_args(annotation)
        return [*_metadata(inner), *own]
    return [each for argument in get_args(annotation) for each in _metadata(argument)]


def _range(annotation: Any) -> str:
    """Return the bounds of the numbers in a type, such as "> 0, ≤ 2"."""
    bounds = [
        f"{kind.shown} {bound:g}".replace("e+0", "e").replace("e+", "e")
        for each in _metadata(annotation)
        if isinstance(each, Range)
        for kind, bound in each.bounds()
    ]
    return ", ".join(dict.fromkeys(bounds))


WORDS = {float: "number", int: "whole number", bool: "true or false", str: "text"}


def _in_words(annotation: Any) -> str:
    """Return the description of a type in words."""
    if get_origin(annotation) is Annotated:
        inner, *own = get_args(annotation)
        lengths = [each.count for each in own if isinstance(each, Length)]
        if any(isinstance(each, Pattern) for each in own):
            return "name"
        words = _in_words(inner)
        return words.replace("list of", f"list of {lengths[0]}", 1) if lengths else words
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        *others, last = (f"`{value}`" for value in arguments)
        return f"{', '.join(others)} or {last}" if others else last
    if origin is tuple:
        return f"list of {_several(_in_words(arguments[0]))}"
    if origin is dict:
        return f"block of {_in_words(arguments[0])}: {_in_words(arguments[1])}"
    if arguments:
        parts = dict.fromkeys(
            "null" if argument is NoneType else _in_words(argument) for argument in arguments
        )
        return ", or ".join(parts)
    return WORDS.get(annotation, "block of keys")


def _several(words: str) -> str:
    """Return the plural of the words of _in_words."""
    for one, several in (("list of", "lists of"), ("block of keys", "blocks of keys")):
        if words.startswith(one):
            return words.replace(one, several, 1)
    return f"{words}s" if words in ("number", "whole number", "text", "name") else words


def _default(field: FieldInfo) -> str | None:
    """Return the default as YAML writes it, None if the key is required."""
    default = field.get_default()
    if default is PydanticUndefined:
        return None
    if isinstance(default, Section):
        default = default.model_dump(mode="json", exclude_unset=True)
    return _written(default)


def _written(value: Any) -> str:
    """Return a value as YAML writes it in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_written(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_written, value)) + "]"
    if isinstance(value, float) and value and not 1.0e-3 <= abs(value) < 1.0e5:
        mantissa, exponent = f"{value:.12e}".split("e")
        digits = mantissa.rstrip("0")
        return f"{digits}{'0' if digits.endswith('.') else ''}e{int(exponent):+d}"
    return value if isinstance(value, str) else json.dumps(value)
