"""The small file with which a user asks for an identified structure: `structure: {kind: identified,
...}`, every other key optional.
"""

from dataclasses import dataclass, field
from difflib import get_close_matches

from pydantic import ValidationError

from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.config.problems import PLAIN_WORDS, shown
from vibroimpact.config.reading import ConfigError, read_yaml

from .local_laws import LAWS

WORD = "identified"  # model=identified: all defaults, no file
KEYS = tuple(MeasuredStructure.model_fields)


@dataclass(frozen=True)
class StructureFile:
    """What the user stated, by the keys of MeasuredStructure; None where it is left to the records.

    band_Hz (low, high); drive: channel at the force; places {name: {channel: coefficient}};
    candidates and additions: names "law.place"; residual_modes (below, above) the band; mean:
    whether the mean of the response counts; emphasis: see trial.Records; mounting: the place whose
    equivalent stiffness and damping are tabled against level; peak_Hz (low, high): where its peak
    lies. source: the file, for messages.
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
    problems = [
        f"unknown key '{key}': beside measured modes that are still to be identified there is only"
        " 'structure'; a whole study needs structure.modes"
        for key in data
        if key != "structure"
    ]
    try:
        stated = MeasuredStructure.model_validate(structure).model_dump(exclude={"kind"})
    except ValidationError as error:
        problems += [_sentence(each) for each in error.errors(include_url=False)]
    problems += [
        problem
        for key in ("candidates", "additions")
        for problem in _unknown_laws(key, structure.get(key))
    ]
    if problems:
        raise ConfigError([f"{path}: {problem}" for problem in problems])
    return StructureFile(**stated, source=str(path))


def _sentence(error):
    """The sentence of one pydantic error: place, value, what is wrong with it and what to do."""
    *path, last = error["loc"]
    if error["type"] == "extra_forbidden":
        close = get_close_matches(str(last), KEYS, n=1)
        return f"unknown key '{last}' in structure: " + (
            f"did you mean '{close[0]}'?" if close else f"known are {', '.join(KEYS)}"
        )
    if last == "[key]":
        return f"structure.{path[0]}: the name {shown(error['input'])} {_rule(error)}"
    place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in error["loc"])
    return f"structure{place} = {shown(error['input'])} {_rule(error)}"


def _rule(error):
    """What is wrong with a value, in the words of a configuration."""
    return PLAIN_WORDS.get(error["type"]) or error["msg"]


def _unknown_laws(key, names):
    """Yield a sentence for every name of a list whose law is not known."""
    for index, name in enumerate(names if isinstance(names, list) else ()):
        law, point, _ = str(name).partition(".")
        if point and law not in LAWS:
            close = get_close_matches(law, LAWS, n=1)
            yield f"structure.{key}[{index}] = {name!r} names no law: " + (
                f"did you mean '{close[0]}'?" if close else f"known are {', '.join(LAWS)}"
            )
