"""Reading YAML: every error is one sentence with file, line, column and remedy."""

import os
from itertools import pairwise

import pytest

from vibroimpact.config.problems import ConfigError
from vibroimpact.config.yaml_file import read_yaml

BROKEN = {
    # name: text, place, what the sentence must hold
    "list": (
        "a: 1\nb: [1, 2\nc: 3\n",
        "line 3, column 2",
        ["[ opens in line 2", "close it with ]"],
    ),
    "block": ("a: {b: 1\nc: 2\n", "line 2, column 2", ["{ opens in line 1", "close it with }"]),
    "colon": ("a: 1\n  b: 2\n", "line 2, column 4", ["a colon", "indentation"]),
    "tab": ("a:\n\tb: 2\n", "line 2, column 1", ["a tab", "indent with spaces"]),
    "no colon": ("a: 1\nb\nc: 2\n", "line 3, column 1", ["a key without a colon"]),
    "dash": ("a:\n  - 1\n - 2\n", "line 3, column 2", ["the indentation does not fit"]),
    "quote": ("a: 'b\nc: 2\n", "line 3, column 1", ["a quote is not closed"]),
    "alias": ("a: *b\n", "line 1, column 4", ["without its anchor"]),
    "start": ("a: 1\nb: @c\n", "line 2, column 4", ["put the text in quotes"]),
    "twice": ("a: 1\nb: 2\na: 3\n", "line 3, column 1", ["key 'a' is given twice", "keep one"]),
    "tag": ("a: !!python/name:os.system x\n", "line 1, column 4", ["is a tag", "remove it"]),
    "own tag": ("a: !circle {r: 1}\n", "line 1, column 4", ["!circle is a tag"]),
    "deep": ("a: " + 9999 * "[", "line 1, column 33", ["nested in more than 30"]),
    "deep blocks": (
        "\n".join(f"{i * ' '}a:" for i in range(999)),
        "line 30, column 30",
        ["nested in more than 30"],
    ),
    "aliases": (
        "a: &a [1, 2, 3, 4, 5, 6, 7, 8, 9, 0]\n"
        + "".join(f"{y}: &{y} [{9 * f'*{x}, '}]\n" for x, y in pairwise("abcdefghijklmnop")),
        "line 6, column 8",
        ["more than 100000 values", "shorten it"],
    ),
    "loop": ("a: &a {b: [*a]}\n", "line 1, column 12", ["an alias inside the block"]),
    "merged loop": ("a: &a\n  <<: *a\n", "line 2, column 7", ["an alias inside the block"]),
    "octal": ("a: 1\nb: 010\n", "line 2, column 4", ["010 is ambiguous"]),
    "base 60": ("a: 1\nb: 1:30\n", "line 2, column 4", ["1:30 is ambiguous"]),
    "date": ("a: 2012-13-45\n", "line 1, column 4", ["a date or number that can not be read"]),
    "digits": (f"a: {5000 * '9'}\n", "line 1, column 4", ["number that can not be read"]),
    "key": ("a: 1\n? [b]\n: 1\n", "line 2, column 3", ["a list or a block as a key"]),
    "surrogate": ('a: "\\ud800"\n', "line 1, column 4", ["remove its escape"]),
    "nul": ('a: "x\\0"\n', "line 1, column 4", ["remove its escape"]),
    "escape": ('a: "\\UFFFFFFFF"\n', "line 1", ["an escape that is no character"]),
    "control": ("a: 1\nb: x\x07\n", "line 2, column 5", ["does not allow", "remove it"]),
    "documents": ("a: 1\n---\nb: 2\n", "line 2, column 1", ["keep one document"]),
}


def refusal(path):
    """The one sentence that a file is refused with."""
    with pytest.raises(ConfigError) as error:
        read_yaml(path)
    (sentence,) = error.value.problems
    return sentence


@pytest.mark.parametrize(("text", "place", "parts"), BROKEN.values(), ids=BROKEN)
def test_a_yaml_error_names_file_line_and_column(tmp_path, text, place, parts):
    path = tmp_path / "x.yaml"
    path.write_text(text)
    sentence = refusal(path)
    assert sentence.startswith(f"{path}: {place}: ")
    assert "\n" not in sentence and "<unicode string>" not in sentence
    for part in parts:
        assert part in sentence


@pytest.mark.parametrize(
    ("content", "part"),
    [
        (b"a: 1\nb: \xff\xfe\n", "line 2, column 4: a character that is not UTF-8"),
        (b"\x89HDF\r\n\x1a\n\0\0", "is a binary file"),
        ("a: 1\n".encode("utf-16"), "16 or 32 bits per character: save the file as UTF-8"),
        ("a: 1\n".encode("utf-32"), "16 or 32 bits per character: save the file as UTF-8"),
        ("a: 1\n".encode("utf-16-be"), "no text in UTF-8"),
        (b"a: 1\n" + bytes(1) + b"\n", "is a binary file or no text in UTF-8"),
        (b"#" * 10_000_001, "is larger than 10 MB"),
        (b"__use_yte__: true\na: 1\n", "__use_yte__ would run the content of the file"),
        (b"", "holds no keys"),
        (b"- 1\n- 2\n", "holds no keys"),
    ],
    ids=[
        *("latin-1", "binary", "utf-16", "utf-32", "no mark", "zero", "huge", "templates"),
        *("empty", "list"),
    ],
)
def test_a_file_that_is_no_yaml_mapping_is_refused(tmp_path, content, part):
    path = tmp_path / "x.yaml"
    path.write_bytes(content)
    assert part in refusal(path)


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    assert "x.yaml: cannot be read" in refusal(tmp_path / "x.yaml")
    assert "is a folder" in refusal(tmp_path)
    os.mkfifo(tmp_path / "pipe")
    assert "is a pipe or a device" in refusal(tmp_path / "pipe")


def test_merge_keys_are_read(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("a: &a {b: 1, c: 2}\nd: {<<: *a, c: 3}\n")
    assert read_yaml(path)["d"] == {"b": 1, "c": 3}


def test_an_anchor_may_stand_for_a_block_many_times(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("a: &a {b: 1, c: [1, 2]}\nd: [*a, *a, *a]\ne: *a\n")
    data = read_yaml(path)
    assert data["d"] == 3 * [{"b": 1, "c": [1, 2]}] and data["e"] == data["a"]


def test_numbers_are_read_as_they_are_written(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("a: [0, -7, 1_000, 0.5, 1.0e+3, 00.5, 0x10]\n")
    assert read_yaml(path)["a"] == [0, -7, 1000, 0.5, 1000.0, 0.5, 16]
