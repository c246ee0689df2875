"""A configuration with some keys changed, as a user would write it."""

import os
from collections.abc import Mapping
from typing import Any

from .reading import check_config, config_of
from .schema import Config


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
