"""Reading a YAML file: the mapping in it, or one sentence with file, line and column."""

import os
from typing import Any

import yaml
from yaml.reader import ReaderError

from .problems import ConfigError
from .yaml_loader import PlainLoader

MOST_BYTES = 10**7
TEMPLATES = "__use_yte__"  # with this key, Snakemake runs the expressions in a file as Python
# Beginnings of text with 16 or 32 bits per character.
WIDE_TEXT = (b"\xff\xfe", b"\xfe\xff", b"\0\0\xfe\xff")

OPENED = {
    "while parsing a flow sequence": ("list", "[", "]"),
    "while parsing a flow mapping": ("block", "{", "}"),
}
# What PlainLoader says of itself with the remedy.
OF_THE_LOADER = (
    *("holds more than", "nested in more than", "an alias inside", "is a tag", "is ambiguous"),
    "can not be read",
)
# Message of PyYAML -> the fault, and the remedy.
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
    ("unexpected end of stream", "a quote is not closed before the end of the file: close it"),
    ("is given twice", "{problem}: keep one of the two"),
    *((told, "{problem}") for told in OF_THE_LOADER),
    ("found unhashable key", "a list or a block as a key: write a text before the colon"),
    ("found undefined alias", "an alias (*name) without its anchor: write &name at its definition"),
    ("cannot start any token", "a character that can not begin a value: put the text in quotes"),
    ("expected a single document", "a second document begins (---): keep one document in the file"),
)
ELSE = "check indentation, colons, brackets and quotes there"


class _Refused(Exception):
    """What is wrong with a file, without its name."""


def read_yaml(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the mapping in a YAML file.

    Raises ConfigError when the file can not be read, is not UTF-8 text, is not YAML, holds a key
    twice or no keys at all, is larger than a configuration can be (see yaml_loader), or asks for
    templates, which run code. The sentence gives the line and the column if there is one.
    """
    try:
        data = _parsed(_text(_content(path)))
        if not isinstance(data, dict):
            raise _Refused("holds no keys: write each as `key: value`")
        if TEMPLATES in data:
            raise _Refused(
                f"{TEMPLATES} would run the content of the file as a program: remove the key"
            )
    except _Refused as error:
        raise ConfigError([f"{path}: {error}"]) from error.__cause__
    return data


def _content(path: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a file. Raises _Refused."""
    if os.path.isdir(path):
        raise _Refused("is a folder: give the path of a file in it")
    if os.path.exists(path) and not os.path.isfile(path):
        raise _Refused("is a pipe or a device: save the configuration to a file")
    try:
        with open(path, "rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except OSError as error:
        told = f"cannot be read ({error.strerror}): give the path of a text file in YAML"
        raise _Refused(told) from error
    if len(raw) > MOST_BYTES:
        raise _Refused(
            f"is larger than {MOST_BYTES // 10**6} MB, which no configuration is: give the path of"
            " a text file in YAML"
        )
    return raw


def _text(raw: bytes) -> str:
    """Return the text that bytes of a file are in UTF-8. Raises _Refused."""
    if raw.startswith(WIDE_TEXT):
        raise _Refused("is text with 16 or 32 bits per character: save the file as UTF-8")
    if b"\0" in raw:
        raise _Refused(
            "is a binary file or no text in UTF-8: give a text file in YAML, saved as UTF-8"
        )
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError as error:
        place = _line_and_column(raw[: error.start].decode("utf-8"))
        told = f"{place}: a character that is not UTF-8: save the file as UTF-8"
        raise _Refused(told) from error


def _parsed(text: str) -> Any:
    """Return the content of a YAML text. Raises _Refused."""
    try:
        loader = PlainLoader(text)
    except ReaderError as error:
        place = _line_and_column(text[: error.position])
        raise _Refused(f"{place}: a character that YAML does not allow: remove it") from error
    try:
        return loader.get_single_data()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise _Refused(f"{place}{_in_plain_words(error)}") from error
    except (ValueError, OverflowError) as error:  # an escape such as "\UFFFFFFFF"
        place = f"line {loader.get_mark().line + 1}"
        told = f"{place}: an escape that is no character: write the character itself"
        raise _Refused(told) from error
    finally:
        loader.dispose()


def _line_and_column(before: str) -> str:
    """Return "line 3, column 5" of the character that follows a text."""
    return f"line {before.count(chr(10)) + 1}, column {len(before) - before.rfind(chr(10))}"


def _in_plain_words(error: yaml.MarkedYAMLError) -> str:
    """Return the fault at the place of an error, and the remedy."""
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
