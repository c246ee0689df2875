"""A configuration with some keys changed, as a user would write it."""

from vibroimpact.config.reading import check_config


def changed(config, values):
    """Return the checked Config with the dotted keys of `values` changed.

    values: {key: value}, such as {"record.duration_s": 24.0}. "supports.points" changes the key in
    every support.

    Raises ConfigError as check_config does, KeyError for a section that does not exist.
    """
    data = config.model_dump(mode="json")
    for key, value in values.items():
        *sections, last = key.split(".")
        level = data
        for section in sections:
            level = level[section]
        for part in level if isinstance(level, list) else [level]:
            part[last] = value
    return check_config(data, f"{config.study} with {', '.join(values)} changed")
