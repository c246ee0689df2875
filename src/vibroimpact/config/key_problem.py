"""A fault that a check between keys of a configuration finds."""

import re
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Any, NamedTuple


class Problem(NamedTuple):
    """A fault: the place of a value, what is wrong with it, and the remedy.

    value: to show in place of the one at the place.
    """

    place: str
    text: str
    value: Any = None


Problems = Iterator[Problem]


def value_at(sections: Mapping[str, Any], place: str) -> Any:
    """Return the value at a place of {name: section}, such as supports[0].profile.depth_m."""
    value: Any = sections
    for key, index in re.findall(r"(\w+)|\[(\d+)\]", place):
        if index:
            value = value[int(index)]
        else:
            value = value[key] if isinstance(value, Mapping) else getattr(value, key)
    return value


def near_or_known(name: str, known: Iterable[str]) -> str:
    """Return the remedy for a name that is unknown: the nearest of the known ones, or all."""
    known = list(known)
    near = get_close_matches(name, known, n=1)
    return f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known)}"
