"""The small file with which a user asks for an identified structure: `structure: {kind: identified,
...}`, every other key optional.
"""

import re
from dataclasses import dataclass, field
from difflib import get_close_matches

from vibroimpact.config.reading import ConfigError, read_yaml

from .local_laws import LAWS
from .study import ELSEWHERE

WORD = "identified"  # model=identified: all defaults, no file
PLACE_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


@dataclass(frozen=True)
class StructureFile:
    """What the user stated; None where it is left to the records.

    band_Hz (low, high); drive: channel at the force; places {name: {channel: coefficient}};
    candidates and additions: names "law.place"; residual_modes (below, above) the band; mean:
    whether the mean of the response counts; emphasis: see trial.Records; mounting: the place whose
    equivalent stiffness and damping are tabled against level; peak_Hz (low, high): where its peak
    lies.
    """

    band_Hz: tuple | None = None
    drive: str | None = None
    places: dict | None = None
    candidates: tuple | None = None
    additions: tuple | None = None
    residual_modes: tuple | None = None
    mean: bool = False
    emphasis: float = 0.0
    mounting: str | None = None
    peak_Hz: tuple | None = None
    source: str = field(default="", compare=False)


def read_structure(path):
    """Return the StructureFile of a YAML file, or None where the file is a model of another kind or
    holds its modes itself.

    Raises ConfigError with every problem: place, value and remedy.
    """
    if path == WORD:
        return StructureFile(source=WORD)
    data = read_yaml(path)
    structure = data.get("structure")
    if (
        not isinstance(structure, dict)
        or structure.get("kind") != "identified"
        or "modes" in structure
    ):
        return None
    problems = [*_unknown_keys(data, structure)]
    values = {}
    for key, check in CHECKS.items():
        if key in structure:
            told = [*check(structure[key])]
            problems += [f"structure.{key}{told_of}" for told_of in told]
            values[key] = structure[key]
    if problems:
        raise ConfigError([f"{path}: {problem}" for problem in problems])
    frozen = {
        key: tuple(value) if isinstance(value, list) else value for key, value in values.items()
    }
    return StructureFile(
        **{key: value for key, value in frozen.items() if value is not None}, source=str(path)
    )


def _unknown_keys(data, structure):
    for key in data:
        if key != "structure":
            yield (
                f"unknown key '{key}': beside measured modes that are still to be identified there"
                " is only 'structure'; a whole study needs structure.modes"
            )
    for key in structure:
        if key not in ("kind", *CHECKS):
            close = get_close_matches(str(key), CHECKS, n=1)
            yield f"unknown key '{key}' in structure: " + (
                f"did you mean '{close[0]}'?" if close else f"known are {', '.join(CHECKS)}"
            )


def _number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _band(value):
    if not (
        isinstance(value, list)
        and len(value) == 2
        and all(map(_number, value))
        and 0.0 <= value[0] < value[1]
    ):
        yield f" = {value!r} must be two frequencies in Hz, the lower one first, as in [5, 60]"


def _text(value):
    if not isinstance(value, str):
        yield f" = {value!r} must be the name of a channel of the campaign, such as a1"


def _places(value):
    if not isinstance(value, dict) or not value:
        yield (
            f" = {value!r} must be a block of places, each with coefficients of channels, as in"
            " joint: {a1: -1, a2: 1}"
        )
        return
    for name, weights in value.items():
        if not PLACE_NAME.fullmatch(str(name)) or name == ELSEWHERE:
            yield (
                f": the name '{name}' must begin with a letter and hold letters, digits, _ and -"
                f" only, and not be '{ELSEWHERE}': it becomes the name of files"
            )
        if (
            not isinstance(weights, dict)
            or not weights
            or not all(map(_number, weights.values()))
            or not any(weights.values())
        ):
            yield (
                f".{name} = {weights!r} must give a coefficient, not all 0, to each channel that"
                " counts, as in {a1: -1, a2: 1}"
            )


def _names(value):
    if not isinstance(value, list) or not value:
        yield f" = {value!r} must be a list of names law.place, as in [cubic_stiffness.joint]"
        return
    for index, name in enumerate(value):
        law = str(name).partition(".")[0]
        if "." not in str(name):
            yield (
                f"[{index}] = {name!r} must be a law and a place with a point between, as in"
                " cubic_stiffness.joint"
            )
        elif law not in LAWS:
            close = get_close_matches(law, LAWS, n=1)
            yield f"[{index}] = {name!r} names no law: " + (
                f"did you mean '{close[0]}'?" if close else f"known are {', '.join(LAWS)}"
            )


def _additions(value):
    if value != []:
        yield from _names(value)


def _two_flags(value):
    if not (
        isinstance(value, list)
        and len(value) == 2
        and all(isinstance(each, bool) for each in value)
    ):
        yield (
            f" = {value!r} must be two of true and false, for modes below and above the band, as in"
            " [true, true]"
        )


def _flag(value):
    if not isinstance(value, bool):
        yield f" = {value!r} must be true or false"


def _place(value):
    if not isinstance(value, str):
        yield f" = {value!r} must be the name of a place, such as joint"


def _emphasis(value):
    if not _number(value) or not 0.0 <= value <= 2.0:
        yield f" = {value!r} must be between 0 (all levels alike) and 2"


CHECKS = {
    "band_Hz": _band,
    "drive": _text,
    "places": _places,
    "candidates": _names,
    "additions": _additions,
    "residual_modes": _two_flags,
    "mean": _flag,
    "emphasis": _emphasis,
    "mounting": _place,
    "peak_Hz": _band,
}
