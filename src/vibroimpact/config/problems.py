"""Problems of a configuration as sentences: the place of a value, the value, what is wrong with it
and what to do.
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date
from difflib import get_close_matches
from typing import Any, get_args

from .quantities import NOT_GIVEN, Section
from .schema import Config

UNKNOWN = "extra_forbidden"
PLAIN_WORDS = {
    "model_type": "must be a block of keys",
    "model_attributes_type": "must be a block of keys",
    "dict_type": "must be a block of keys",
    "tuple_type": "must be a list",
    "float_type": "must be a number",
    "float_parsing": "must be a number",
    "int_type": "must be a whole number",
    "int_parsing": "must be a whole number",
    "int_from_float": "must be a whole number",
    "string_type": "must be a text",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
    "finite_number": "must be a finite number",
    "too_short": "must not be empty",
}


class ConfigError(Exception):
    """A configuration that can not be used.

    problems: one sentence per problem; str() gives one line each.
    """

    def __init__(self, problems: list[str]):
        super().__init__("\n".join(problems))
        self.problems = problems


def sentence(error: Mapping[str, Any], data: Any, whole: type[Section] = Config) -> str:
    """Return "place = value rule: remedy" for one pydantic error of the mapping `data`.

    whole: the section that it states.
    """
    path, known, value = _resolve(error["loc"], data, whole)
    place = _place(path)
    if error["type"] == UNKNOWN:
        close = get_close_matches(str(error["loc"][-1]), known, n=1)
        remedy = f"did you mean '{close[0]}'?" if close else f"known are {', '.join(known)}"
        parent = _place(path[:-1])
        return f"unknown key '{error['loc'][-1]}'{f' in {parent}' if parent else ''}: {remedy}"
    if error["type"] == "missing":
        return f"{place} is missing: config/study.yaml shows it with its unit"
    if error["type"] == "invalid_key":
        return (
            f"the key {shown(error['loc'][-1])} of {_place(path[:-1]) or 'the file'} must be a text"
        )
    if error["type"] == NOT_GIVEN:
        return f"{place} {error['msg']}"
    if error["type"] == "union_tag_not_found":
        return f"{place}.kind is missing: config/study.yaml shows the block with its kind"
    if error["type"] == "union_tag_invalid":
        return (
            f"{place}.kind = {shown(error['ctx']['tag'])} must be one of"
            f" {error['ctx']['expected_tags']}"
        )
    text = PLAIN_WORDS.get(error["type"]) or error["msg"].replace("Input should be", "must be")
    if "[key]" in error["loc"]:
        return f"the key of {place} {text}"
    return f"{place} = {shown(value)} {text}"


def shown(value: Any) -> str:
    """Return a value as a reader of YAML would write it, at most 60 characters."""
    plain = isinstance(value, date)
    text = str(value) if plain else repr(list(value) if isinstance(value, tuple) else value)
    return text if len(text) <= 60 else text[:57] + "..."


def path_in(location: tuple, data: Any) -> list:
    """Return the path of keys and indices that a pydantic location means in `data`."""
    return _resolve(location, data)[0]


def _place(path: list) -> str:
    """Return a path of keys and indices as a reader of YAML would write it: grid.gap_m[2]."""
    return "".join(
        f"[{part}]" if isinstance(part, int) else f".{part}" for part in path
    ).removeprefix(".")


def _resolve(
    location: tuple, data: Any, whole: type[Section] = Config
) -> tuple[list, list[str], Any]:
    """Return (path of keys and indices, keys known beside its last part, value) for a pydantic
    location in `data`.

    Pydantic's location also names the member of a union. Such a part is no key of the data and is
    left out of the path.
    """
    model: type[Section] | None = whole
    annotation: Any = None
    path: list = []
    known = list(whole.model_fields)
    for index, part in enumerate(location):
        in_data = (isinstance(data, dict) and part in data) or (
            isinstance(data, (list, tuple)) and isinstance(part, int) and part < len(data)
        )
        if (
            part == "[key]"
            or (not in_data and index < len(location) - 1)
            or (not in_data and part in ("one", "list"))
        ):
            annotation = next((m for m in members(annotation) if kind_of(m) == part), annotation)
            model = annotation if _is_section(annotation) else model
            continue
        known = list(model.model_fields) if model is not None else []
        data = data[part] if in_data else None
        path.append(part)
        if isinstance(part, str):
            fields = model.model_fields if model is not None else {}
            annotation = fields[part].annotation if part in fields else None
        sections = [member for member in members(annotation) if _is_section(member)]
        model = sections[0] if len(sections) == 1 else None
    return path, known, data


def members(annotation: Any) -> list:
    """Return the classes found anywhere inside a type such as tuple[Annotated[A | B, ...], ...]."""
    inner = [member for argument in get_args(annotation) for member in members(argument)]
    return inner or [annotation]


def kind_of(member: Any) -> str | None:
    """Return the value of `kind` that selects a section among its alternatives, None without."""
    field = getattr(member, "model_fields", {}).get("kind")
    return get_args(field.annotation)[0] if field else None


def _is_section(member: Any) -> bool:
    """Whether a member of a type is a block of keys."""
    return isinstance(member, type) and issubclass(member, Section)
