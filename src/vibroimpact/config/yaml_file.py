"""Reading a YAML file: the mapping in it, or one sentence with file, line and column."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import yaml
from yaml.nodes import MappingNode
from yaml.reader import ReaderError

from .problems import ConfigError

OPENED = {
    "while parsing a flow sequence": ("list", "[", "]"),
    "while parsing a flow mapping": ("block", "{", "}"),
}
# What PyYAML says -> what is wrong, and the remedy.
PLAIN_WORDS = (
    (
        "mapping values are not allowed here",
        "a colon where no key can be: check the indentation of this line and of the one above, and"
        " put a text that holds ': ' in quotes",
    ),
    ("found character '\\t'", "a tab: indent with spaces"),
    ("could not find expected ':'", "a key without a colon: write it as key: value"),
    (
        "expected <block end>",
        "the indentation does not fit the lines above: align the keys of a block, and the dashes of"
        " a list",
    ),
    ("did not find expected key", "no key where one is expected: write it as key: value"),
    (
        "unexpected end of stream",
        "a quote is not closed before the end of the file: close it",
    ),
    ("is given twice", "{problem}: keep one of the two"),
    ("found undefined alias", "an alias (*name) without its anchor: write &name where it is meant"),
    (
        "cannot start any token",
        "a character that can not begin a value: put the text in quotes",
    ),
    ("expected a single document", "a second document begins (---): keep one document in the file"),
)
ELSE = "check indentation, colons, brackets and quotes there"


def read_yaml(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the mapping in a YAML file.

    Raises ConfigError when the file can not be read, is no UTF-8 text, is not YAML, holds a key
    twice or no keys at all. The sentence gives the line and the column where there is one.
    """
    data = _parsed(path, _text(path))
    if not isinstance(data, dict):
        raise ConfigError([f"{path}: holds no keys: start from a copy of config/study.yaml"])
    return data


def _text(path: str | os.PathLike[str]) -> str:
    """Return the text of a file. Raises ConfigError."""
    try:
        raw = Path(path).read_bytes()
    except IsADirectoryError as error:
        raise ConfigError([f"{path}: is a folder: give the path of a file in it"]) from error
    except OSError as error:
        raise ConfigError(
            [
                f"{path}: cannot be read ({error.strerror}): give the path of a configuration, such"
                " as config/study.yaml"
            ]
        ) from error
    if b"\0" in raw:
        raise ConfigError(
            [f"{path}: is a binary file: give a configuration as text, such as config/study.yaml"]
        )
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError as error:
        place = _line_and_column(raw[: error.start].decode("utf-8"))
        raise ConfigError(
            [f"{path}: {place}: a character that is not UTF-8: save the file as UTF-8"]
        ) from error


def _parsed(path: str | os.PathLike[str], text: str) -> Any:
    """Return what a YAML text holds. Raises ConfigError."""
    try:
        return yaml.load(text, Loader=_UniqueKeys)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise ConfigError([f"{path}: {place}{_in_plain_words(error)}"]) from error
    except ReaderError as error:
        place = _line_and_column(text[: error.position])
        raise ConfigError(
            [f"{path}: {place}: a character that YAML does not allow: remove it"]
        ) from error


def _line_and_column(before: str) -> str:
    """Return "line 3, column 5" of the character that follows a text."""
    return f"line {before.count(chr(10)) + 1}, column {len(before) - before.rfind(chr(10))}"


def _in_plain_words(error: yaml.MarkedYAMLError) -> str:
    """Return what is wrong at the place of an error, and the remedy."""
    problem, context = error.problem or "", error.context or ""
    if context in OPENED and error.context_mark and problem.startswith("expected"):
        what, opening, closing = OPENED[context]
        line = error.context_mark.line + 1
        return (
            f"the {what} that {opening} opens in line {line} is not continued here: put a comma"
            f" between its entries, or close it with {closing}"
        )
    for part, words in PLAIN_WORDS:
        if part in f"{problem} {context}":
            return words.replace("{problem}", problem)
    return f"is not valid YAML ({', '.join(filter(None, [problem, context]))}): {ELSE}"


class _UniqueKeys(yaml.SafeLoader):
    """YAML's safe loader, except that a key given twice is an error. PyYAML would keep the last."""

    def construct_mapping(self, node: MappingNode, deep: bool = False) -> dict:
        """Return the mapping of a node. Raises ConstructorError."""
        given: list[Any] = []
        for key_node, _ in node.value:
            if key_node.tag == "tag:yaml.org,2002:merge":
                continue
            key = self.construct_object(key_node, deep=True)
            if key in given:
                raise yaml.constructor.ConstructorError(
                    None,
                    None,
                    f"key '{key}' is given twice",
                    key_node.start_mark,
                )
            given.append(key)
        return super().construct_mapping(node, deep)
