"""Reading and checking a configuration: a Config, or every problem at once with its place, value
and remedy.
"""

from __future__ import annotations

import copy
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, get_args

import yaml
from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from .checks import cross_problems
from .quantities import Section
from .schema import Config

__all__ = ["Config", "ConfigError", "check_config", "load_config"]

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
    """A configuration that can not be used; `problems` holds one sentence per problem, str() one
    line each.
    """

    def __init__(self, problems: list[str]):
        super().__init__("\n".join(problems))
        self.problems = problems


def load_config(path, overrides: dict | None = None) -> Config:
    """Return the checked Config of a YAML file, its top-level keys replaced by those of
    `overrides`.

    Raises ConfigError: the file is missing, is not YAML, has a key twice, or any problem of
    check_config.
    """
    return check_config({**read_yaml(path), **(overrides or {})}, str(path))


def read_yaml(path) -> dict:
    """Return the mapping in a YAML file. Raises ConfigError when it is missing, is not YAML, or
    holds a key twice.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
        data = yaml.load(text, Loader=_UniqueKeys)
    except OSError as error:
        raise ConfigError(
            [
                f"{path}: cannot be read ({error.strerror}): give the path of a configuration, such"
                " as config/study.yaml"
            ]
        ) from error
    except yaml.YAMLError as error:
        raise ConfigError([f"{path}: is not valid YAML: {' '.join(str(error).split())}"]) from error
    if not isinstance(data, dict):
        raise ConfigError([f"{path}: holds no keys: start from a copy of config/study.yaml"])
    return data


def check_config(data: dict, source: str) -> Config:
    """Return the Config of a mapping as YAML gives it. Raises ConfigError with every problem;
    `source` opens each line.
    """
    problems = []
    try:
        config = Config.model_validate(data)
        sections = {name: getattr(config, name) for name in Config.model_fields}
    except ValidationError as error:
        lines = error.errors(include_url=False)
        problems = [_sentence(line, data) for line in lines]
        sections = _valid_sections(
            _without_unknown_keys(data, lines),
            {line["loc"][0] for line in lines if line["type"] != UNKNOWN},
        )
    problems += [
        f"{place} = {_shown(value)} {text}" for place, value, text in cross_problems(sections)
    ]
    if problems:
        raise ConfigError([f"{source}: {problem}" for problem in dict.fromkeys(problems)])
    return config


class _UniqueKeys(yaml.SafeLoader):
    """YAML's safe loader, except that a key given twice is an error (YAML would silently keep the
    last).
    """

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        for index, key in enumerate(keys):
            if key in keys[:index]:
                raise yaml.constructor.ConstructorError(
                    None, None, f"key '{key}' is given twice", node.value[index][0].start_mark
                )
        return super().construct_mapping(node, deep)


def _valid_sections(data: dict, invalid: set) -> dict:
    """Return {name: section} of the sections that are valid by themselves, with defaults where a
    section is absent.
    """
    sections = {}
    for name, field in Config.model_fields.items():
        if name in data and name not in invalid:
            sections[name] = TypeAdapter(_annotation(field)).validate_python(data[name])
        elif name not in data and not field.is_required():
            sections[name] = field.get_default()
    return sections


def _without_unknown_keys(data: dict, lines: list[dict]) -> dict:
    """Return a copy of the mapping without the keys that pydantic does not know, so that the rest
    can be checked.
    """
    known = copy.deepcopy(data)
    for line in lines:
        if line["type"] == UNKNOWN:
            *path, last = _resolve(line["loc"], data)[0]
            level = known
            for part in path:
                level = level[part]
            level.pop(last, None)
    return known


def _annotation(field: FieldInfo) -> Any:
    """The full type of a field: pydantic keeps what stood in Annotated apart."""
    extras = [*field.metadata] + ([field] if field.discriminator else [])
    return Annotated[(field.annotation, *extras)] if extras else field.annotation


def _sentence(line: dict, data: Any) -> str:
    """Return 'place = value rule: remedy' for one pydantic error of the mapping `data`."""
    path, known, value = _resolve(line["loc"], data)
    place = _place(path)
    if line["type"] == UNKNOWN:
        close = get_close_matches(str(line["loc"][-1]), known, n=1)
        remedy = f"did you mean '{close[0]}'?" if close else f"known are {', '.join(known)}"
        parent = _place(path[:-1])
        return f"unknown key '{line['loc'][-1]}'{f' in {parent}' if parent else ''}: {remedy}"
    if line["type"] == "missing":
        return f"{place} is missing: config/study.yaml shows it with its unit"
    if line["type"] == "union_tag_not_found":
        return f"{place}.kind is missing: config/study.yaml shows the block with its kind"
    if line["type"] == "union_tag_invalid":
        return (
            f"{place}.kind = {_shown(line['ctx']['tag'])} must be one of"
            f" {line['ctx']['expected_tags']}"
        )
    text = PLAIN_WORDS.get(line["type"]) or line["msg"].replace("Input should be", "must be")
    if "[key]" in line["loc"]:
        return f"the key of {place} {text}"
    return f"{place} = {_shown(value)} {text}"


def _place(path: list) -> str:
    """Return a path of keys and indices as a reader of YAML would write it: grid.gap_m[2]."""
    return "".join(
        f"[{part}]" if isinstance(part, int) else f".{part}" for part in path
    ).removeprefix(".")


def _resolve(loc: tuple, data: Any) -> tuple[list, list[str], Any]:
    """Return (path of keys and indices, keys known beside its last part, value) for a pydantic
    location in `data`.

    Pydantic's location also names the member of a union; such a part is no key of the data and is
    left out of the path.
    """
    model, annotation, path, known = Config, None, [], list(Config.model_fields)
    for index, part in enumerate(loc):
        in_data = (isinstance(data, dict) and part in data) or (
            isinstance(data, (list, tuple)) and isinstance(part, int) and part < len(data)
        )
        if (
            part == "[key]"
            or (not in_data and index < len(loc) - 1)
            or (not in_data and part in ("one", "list"))
        ):
            annotation = next((m for m in _members(annotation) if _kind(m) == part), annotation)
            model = (
                annotation
                if isinstance(annotation, type) and issubclass(annotation, Section)
                else model
            )
            continue
        known = list(model.model_fields) if model else []
        data = data[part] if in_data else None
        path.append(part)
        if isinstance(part, str):
            annotation = (
                model.model_fields[part].annotation
                if model and part in model.model_fields
                else None
            )
        members = [
            m for m in _members(annotation) if isinstance(m, type) and issubclass(m, Section)
        ]
        model = members[0] if len(members) == 1 else None
    return path, known, data


def _members(annotation: Any) -> list:
    """Return the classes found anywhere inside a type such as tuple[Annotated[A | B, ...], ...]."""
    inner = [member for argument in get_args(annotation) for member in _members(argument)]
    return inner or [annotation]


def _kind(member: Any) -> str | None:
    """Return the value of `kind` that selects a section among its alternatives."""
    field = getattr(member, "model_fields", {}).get("kind")
    return get_args(field.annotation)[0] if field else None


def _shown(value: Any) -> str:
    """Return a value as a reader of YAML would write it."""
    text = repr(list(value) if isinstance(value, tuple) else value)
    return text if len(text) <= 60 else text[:57] + "..."
