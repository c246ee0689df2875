"""Reading and checking a configuration: a Config, or every problem at once with its place, value
and remedy.
"""

from __future__ import annotations

import copy
import os
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from .checks import cross_problems
from .problems import UNKNOWN, ConfigError, path_in, sentence, shown
from .schema import Config
from .yaml_file import read_yaml

__all__ = ["Config", "ConfigError", "check_config", "load_config", "read_yaml"]


def load_config(path: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None) -> Config:
    """Return the checked Config of a YAML file.

    overrides: {top-level key: value} that replace those of the file.
    Raises ConfigError with every problem of read_yaml or of check_config.
    """
    return check_config({**read_yaml(path), **(overrides or {})}, str(path))


def check_config(data: dict[str, Any], source: str) -> Config:
    """Return the Config of a mapping as YAML gives it.

    source: what the mapping was read from; it begins every sentence.
    Raises ConfigError with every problem.
    """
    problems = []
    config = None
    try:
        config = Config.model_validate(data)
        sections = {name: getattr(config, name) for name in Config.model_fields}
    except ValidationError as error:
        errors = error.errors(include_url=False)
        problems = [sentence(each, data) for each in errors]
        sections = _valid_sections(
            _without_unknown_keys(data, errors),
            {each["loc"][0] for each in errors if each["type"] != UNKNOWN},
        )
    problems += [
        f"{place} = {shown(value)} {text}" for place, value, text in cross_problems(sections)
    ]
    if problems or config is None:
        raise ConfigError([f"{source}: {problem}" for problem in dict.fromkeys(problems)])
    return config


def _valid_sections(data: dict[str, Any], invalid: set) -> dict[str, Any]:
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


def _without_unknown_keys(data: dict[str, Any], errors: Sequence[Mapping[str, Any]]) -> dict:
    """Return a copy of the mapping without the keys that are not declared, so that the rest can be
    checked.
    """
    known = copy.deepcopy(data)
    for error in errors:
        if error["type"] == UNKNOWN:
            *path, last = path_in(error["loc"], data)
            level = known
            for part in path:
                level = level[part]
            level.pop(last, None)
    return known


def _annotation(field: FieldInfo) -> Any:
    """Return the full type of a field: pydantic keeps what stood in Annotated apart."""
    extras = [*field.metadata] + ([field] if field.discriminator else [])
    return Annotated[(field.annotation, *extras)] if extras else field.annotation
