"""Problems of a configuration as sentences: the place of a value, the value, the fault and the
remedy.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from typing import Any

from pydantic.fields import FieldInfo

from .declared_keys import declared, kind_of, members, sections_in
from .key_problem import near_or_known
from .quantities import NOT_GIVEN, Section

UNKNOWN = "extra_forbidden"
PLAIN_WORDS = {
    **dict.fromkeys(
        ("model_type", "model_attributes_type", "dict_type"), "must be a block of keys"
    ),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float"), "must be a whole number"),
    **dict.fromkeys(("float_type", "float_parsing"), "must be a number"),
    **dict.fromkeys(("bool_type", "bool_parsing"), "must be true or false"),
    "tuple_type": "must be a list",
    "string_type": "must be a text",
    "finite_number": "must be a finite number",
    "int_parsing_size": "is too large a whole number: give at most 9223372036854775807",
}


class ConfigError(Exception):
    """A configuration that can not be used.

    problems: one sentence per problem; str() gives one line each.
    mended: the configuration with its mistakes put right, if that leaves no doubt: for checks
        that need a whole one.
    """

    def __init__(self, problems: list[str], mended: Any = None):
        super().__init__("\n".join(problems))
        self.problems, self.mended = problems, mended


def sentence(error: Mapping[str, Any], data: Any, whole: type[Section]) -> str:
    """Return "place = value rule: remedy" for one pydantic error of the mapping `data`.

    whole: the section that it states.
    """
    found = place_in(error["loc"], data, whole)
    path, value = found.path, found.value
    place = _place(path)
    if error["type"] == UNKNOWN:
        key, parent = error["loc"][-1], _place(path[:-1])
        remedy = near_or_known(str(key), found.keys)
        return f"unknown key '{key}'{f' in {parent}' if parent else ''}: {remedy}"
    if error["type"] == "missing":
        return f"{place} is missing: {_wanted(str(path[-1]), found.keys[path[-1]])}"
    if error["type"] == "invalid_key":
        return (
            f"the key {shown(error['loc'][-1])} of {_place(path[:-1]) or 'the file'} must be a text"
        )
    if error["type"] == NOT_GIVEN:
        return f"{place} {error['msg']}"
    if error["type"] == "union_tag_not_found":
        return f"{place}.kind is missing: give one of {_kinds(found.sections)}"
    if error["type"] == "union_tag_invalid":
        return (
            f"{place}.kind = {shown(error['ctx']['tag'])} must be one of"
            f" {error['ctx']['expected_tags']}"
        )
    if error["type"] == "too_short":
        least = error["ctx"]["min_length"]
        return f"{place} = {shown(value)} " + (
            "must not be empty" if least == 1 else f"has too few values: give {least} or more"
        )
    text = in_words(error)
    if "[key]" in error["loc"]:
        return f"the key of {place} {text}"
    return f"{place} = {shown(value)} {text}"


def in_words(error: Mapping[str, Any]) -> str:
    """Return what a pydantic error says of a value, as the end of a sentence."""
    return PLAIN_WORDS.get(error["type"]) or error["msg"].replace("Input should be", "must be")


def follows(error: Mapping[str, Any]) -> bool:
    """Whether an error says no more than another one: a list that is too short without the values
    that are wrong.
    """
    return error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]


def shown(value: Any) -> str:
    """Return a value as a reader of YAML would write it, at most 60 characters."""
    plain = isinstance(value, date)
    text = str(value) if plain else repr(list(value) if isinstance(value, tuple) else value)
    return text if len(text) <= 60 else text[:57] + "..."


def _wanted(name: str, field: FieldInfo) -> str:
    """Return the description of a missing key, and a value that it could have."""
    key = declared(name, field)
    meaning = key.meaning.split(". ")[0].rstrip(".")
    if meaning[1:2].islower():
        meaning = meaning[0].lower() + meaning[1:]
    if len(key.sections) > 1 and not key.example:
        return f"{meaning} (block of keys, kind one of {_kinds(key.sections)})"
    if key.sections and not key.example:
        return f"{meaning} (block of keys: {', '.join(key.sections[0].model_fields)})"
    unit = f" in {key.unit}" if key.unit not in ("", "1") else ""
    return f"{meaning} ({key.holds}{unit}, such as {key.example})"


def _kinds(sections: tuple[type[Section], ...]) -> str:
    """Return the kinds of alternative sections, such as "path, chain"."""
    return ", ".join(kind for section in sections if (kind := kind_of(section)))


def _place(path: list) -> str:
    """Return a path of keys and indices as a reader of YAML would write it: grid.gap_m[2]."""
    return "".join(
        f"[{part}]" if isinstance(part, int) else f".{part}" for part in path
    ).removeprefix(".")


@dataclass(frozen=True)
class Place:
    """A place of a configuration.

    path: keys and indices. value: the value there, None if there is none.
    keys: {name: field} of those known at the last part of the path.
    sections: that the value can be, or consists of.
    """

    path: list
    value: Any
    keys: Mapping[str, FieldInfo]
    sections: tuple[type[Section], ...]


def place_in(location: tuple, data: Any, whole: type[Section]) -> Place:
    """Return the place that a pydantic location means in `data`.

    Pydantic's location also names the member of a union. Such a part is not a key of the data and
    is left out of the path.
    """
    model: type[Section] | None = whole
    annotation: Any = None
    path: list = []
    keys: Mapping[str, FieldInfo] = whole.model_fields
    for index, part in enumerate(location):
        if isinstance(data, (list, tuple)):
            in_data = isinstance(part, int) and part < len(data)
        else:
            in_data = isinstance(data, dict) and part in data
        last = index == len(location) - 1
        if part == "[key]" or (not in_data and (not last or part in ("one", "list"))):
            annotation = next((m for m in members(annotation) if kind_of(m) == part), annotation)
            model = annotation if annotation in sections_in(annotation) else model
            continue
        keys = model.model_fields if model is not None else {}
        data = data[part] if in_data else None
        path.append(part)
        if isinstance(part, str):
            annotation = keys[part].annotation if part in keys else None
        sections = sections_in(annotation)
        model = sections[0] if len(sections) == 1 else None
    return Place(path, data, keys, sections_in(annotation))
