"""What a user states of a structure without a model: `structure: {kind: identified, ...}`."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.config.problems import PLAIN_WORDS, shown
from vibroimpact.config.reading import ConfigError, check_config, load_config, read_yaml
from vibroimpact.config.schema import Config

from .local_laws import LAWS

WORD = "identified"  # in place of a file: every choice is left to the records
KEYS = tuple(MeasuredStructure.model_fields)


def model_of(model: Config | MeasuredStructure | str | Path) -> Config | MeasuredStructure:
    """Return a model as it is checked, or as a file or WORD states it. Raises ConfigError."""
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
    """Return the MeasuredStructure of a YAML file or of WORD; None where the file is a model of
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
        problems += [_sentence(each) for each in error.errors(include_url=False)]
    for key in ("candidates", "additions"):
        problems += _unknown_laws(key, structure.get(key))
    if problems:
        raise ConfigError([f"{path}: {problem}" for problem in problems])
    return stated


def _sentence(error: Any) -> str:
    """Return the sentence of one pydantic error: place, value, what is wrong, what to do."""
    *path, last = error["loc"]
    if error["type"] == "extra_forbidden":
        close = get_close_matches(str(last), KEYS, n=1)
        remedy = f"did you mean '{close[0]}'?" if close else f"known are {', '.join(KEYS)}"
        return f"unknown key '{last}' in structure: {remedy}"
    rule = PLAIN_WORDS.get(error["type"]) or error["msg"]
    if last == "[key]":
        return f"structure.{path[0]}: the name {shown(error['input'])} {rule}"
    place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in error["loc"])
    return f"structure{place} = {shown(error['input'])} {rule}"


def _unknown_laws(key: str, names: Any) -> Iterator[str]:
    """Yield a sentence for every name of a list whose law is not known."""
    for index, name in enumerate(names if isinstance(names, list) else ()):
        law, point, _ = str(name).partition(".")
        if point and law not in LAWS:
            close = get_close_matches(law, LAWS, n=1)
            remedy = f"did you mean '{close[0]}'?" if close else f"known are {', '.join(LAWS)}"
            yield f"structure.{key}[{index}] = {name!r} names no law: {remedy}"
