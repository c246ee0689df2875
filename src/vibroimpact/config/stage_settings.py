"""The part of a configuration that a stage of the workflow is given, with the attribute names of
Config.
"""

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias


class StageSettings(Mapping[str, Any]):
    """The view of a configuration that a stage gets: its keys read as attributes,
    `settings.record.duration_s`, or as a mapping, `settings.points["apex"]`. Lists are tuples.

    values: {key: value}, as stage_keys.stage_params gives them; a dotted key such as
    "record.duration_s" fills one part of a section.
    Reading a key that was not given raises AttributeError (KeyError as a mapping). The message
    states the place in which a stage declares its keys.
    """

    def __init__(self, values: Mapping[str, Any], place: str = ""):
        nested: dict[str, Any] = {}
        for key, value in values.items():
            *sections, last = key.split(".")
            level = nested
            for section in sections:
                level = level.setdefault(section, {})
            level[last] = value
        self.__dict__["_place"] = place
        self.__dict__["_values"] = {
            key: _frozen(value, f"{place}{key}.") for key, value in nested.items()
        }

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return self.__dict__["_values"][name]
        except KeyError:
            raise AttributeError(
                f"key '{self.__dict__.get('_place', '')}{name}' was not given to this stage:"
                " declare it in STAGE_KEYS of config/stage_keys.py, or correct its name"
            ) from None

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"settings can not be changed ('{name}')")

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return f"StageSettings({self._values!r})"


def _frozen(value: Any, place: str) -> Any:
    """Return a value with its sections as StageSettings and its lists as tuples."""
    if isinstance(value, Mapping):
        return StageSettings(value, place)
    if isinstance(value, (list, tuple)):
        return tuple(_frozen(item, place) for item in value)
    return value


# The configuration of a function of the library: the StageSettings of a stage, or the same part of
# a whole Config. The schema checks the values, so the annotation is Any.
ConfigPart: TypeAlias = Any
