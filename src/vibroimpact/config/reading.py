"""Reading and checking a configuration: a Config, or every problem at once with its place, value
and remedy.
"""

import copy
import os
import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from pydantic import TypeAdapter, ValidationError

from .checks import cross_problems
from .declared_keys import annotation_of
from .problems import UNKNOWN, ConfigError, follows, place_in, sentence, shown
from .schema import Config
from .yaml_file import read_yaml

__all__ = ["Config", "ConfigError", "check_config", "load_config", "read_yaml"]


def load_config(path: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None) -> Config:
    """Return the checked Config of a YAML file.

    overrides: {top-level key: value} that replace those of the file.
    Raises ConfigError with every problem of read_yaml or of check_config.
    """
    return check_config({**read_yaml(path), **(overrides or {})}, str(path))


def config_of(config: Config | str | os.PathLike[str]) -> Config:
    """Return a configuration as it is given, or that of a YAML file.

    Raises ConfigError as load_config does, and for other objects.
    """
    if isinstance(config, (str, os.PathLike)):
        return load_config(config)
    if not hasattr(config, "structure"):
        raise ConfigError(
            [f"{type(config).__name__} is no configuration: give a Config, or the path of a file"]
        )
    return config


def changed_config(config: Config | str | os.PathLike[str], values: Mapping[str, Any]) -> Config:
    """Return the checked Config with the dotted keys of `values` changed.

    config: a Config, or the path of a file.
    values: {key: value}, such as {"record.duration_s": 24.0}. "supports.points" changes the key in
        every support.
    Raises ConfigError as check_config does, KeyError for a section that does not exist.
    """
    config = config_of(config)
    data = config.model_dump(mode="json")
    for key, value in values.items():
        *sections, last = key.split(".")
        level = data
        for section in sections:
            level = level[section]
        for part in level if isinstance(level, list) else [level]:
            part[last] = value
    return check_config(data, f"{config.study} with {', '.join(values)} changed")


def check_config(data: dict[str, Any], source: str) -> Config:
    """Return the Config of a mapping as YAML gives it.

    source: the origin of the mapping; it begins every sentence.
    Raises ConfigError with every problem.
    """
    problems: list[str] = []
    mended: dict[str, Any] | None = data
    while mended is not None:  # once more if a mistake has hidden others
        read, errors = mended, []
        config = None
        try:
            config = Config.model_validate(read)
            sections = {name: getattr(config, name) for name in Config.model_fields}
        except ValidationError as error:
            errors = [each for each in error.errors(include_url=False) if not follows(each)]
            sections = _valid_sections(read, {each["loc"][0] for each in errors})
        problems += [sentence(each, read, Config) for each in errors]
        mended = _mended(read, errors)
    between = cross_problems(sections)
    problems += [f"{each.place} = {shown(each.value)} {each.text}" for each in between]
    if problems or config is None:
        told = [f"{source}: {problem}" for problem in dict.fromkeys(problems)]
        raise ConfigError(told, None if between else config)
    return config


def _valid_sections(data: dict[str, Any], invalid: set) -> dict[str, Any]:
    """Return {name: section} of the sections that are valid by themselves, with defaults if a
    section is absent.
    """
    sections = {}
    for name, field in Config.model_fields.items():
        if name in data and name not in invalid:
            sections[name] = TypeAdapter(annotation_of(field)).validate_python(data[name])
        elif name not in data and not field.is_required():
            sections[name] = field.get_default()
    return sections


def _mended(data: dict[str, Any], errors: Sequence[Mapping[str, Any]]) -> dict[str, Any] | None:
    """Return a copy of the mapping without undeclared keys and with misspelled words put right, so
    that the rest can be checked; None if there is nothing of the kind.
    """
    copied, mended = copy.deepcopy(data), False
    for error in errors:
        path, words = place_in(error["loc"], data, Config).path, error.get("ctx", {})
        if error["type"] == "union_tag_invalid":
            path.append("kind")
        level: Any = copied
        for part in path[:-1]:
            level = level[part]
        if error["type"] == UNKNOWN:
            level.pop(path[-1], None)
            mended = True
            continue
        known = re.findall("'([^']*)'", words.get("expected_tags") or words.get("expected") or "")
        given = level[path[-1]] if known else None
        if isinstance(given, str) and (meant := get_close_matches(given, known, 1)):
            level[path[-1]], mended = meant[0], True
    return copied if mended else None
