"""A user's statements on a structure without a model: `structure: {kind: identified, ...}`."""

from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.config.problems import PLAIN_WORDS, sentence, shown
from vibroimpact.config.quantities import Section
from vibroimpact.config.reading import ConfigError, check_config, load_config, read_yaml
from vibroimpact.config.schema import Config

from .local_laws import LAWS

WORD = "identified"  # in place of a file: every choice is left to the records


class _File(Section):
    """The content of a file."""

    structure: MeasuredStructure


def model_of(model: Config | MeasuredStructure | str | Path) -> Config | MeasuredStructure:
    """Return a checked model: as given, or of a file or WORD. Raises ConfigError."""
    if isinstance(model, (Config, MeasuredStructure)):
        return model
    stated = read_structure(str(model))
    return load_config(model) if stated is None else stated


def model_from(values: dict[str, Any]) -> Config | MeasuredStructure:
    """Return the model of plain values, as values_of gives them. Raises ConfigError."""
    stated = _stated(values, "model")
    return check_config(values, "model") if stated is None else stated


def values_of(model: Config | MeasuredStructure) -> dict[str, Any]:
    """Return the plain values of a model, as its file holds them."""
    values = model.model_dump(mode="json")
    return {"structure": values} if isinstance(model, MeasuredStructure) else values


def read_structure(path: str) -> MeasuredStructure | None:
    """Return the MeasuredStructure of a YAML file or of WORD; None if the file is a model of
    another kind, or holds its modes itself.

    Raises ConfigError with every problem: place, value and remedy.
    """
    return MeasuredStructure(kind="identified") if path == WORD else _stated(read_yaml(path), path)


def _stated(data: dict[str, Any], path: str) -> MeasuredStructure | None:
    """Return the MeasuredStructure of the content of a file, see read_structure."""
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
    stated = None
    try:
        stated = MeasuredStructure.model_validate(structure)
    except ValidationError as error:
        for each in error.errors(include_url=False):
            place, rule = each["loc"], PLAIN_WORDS.get(each["type"]) or each["msg"]
            told = sentence({**each, "loc": ("structure", *place)}, data, _File)
            if place[-1] == "[key]":
                told = f"structure.{place[0]}: the name {shown(each['input'])} {rule}"
            problems.append(told)
    for key in ("candidates", "additions"):
        problems += _unknown_laws(key, structure.get(key))
    if problems:
        raise ConfigError([f"{path}: {problem}" for problem in problems])
    return stated


def _unknown_laws(key: str, names: Any) -> Iterator[str]:
    """Yield a sentence for every name of a list whose law is not known."""
    for index, name in enumerate(names if isinstance(names, list) else ()):
        law, point, _ = str(name).partition(".")
        if point and law not in LAWS:
            close = get_close_matches(law, LAWS, n=1)
            remedy = f"did you mean '{close[0]}'?" if close else f"known are {', '.join(LAWS)}"
            yield f"structure.{key}[{index}] = {name!r} names no law: {remedy}"
