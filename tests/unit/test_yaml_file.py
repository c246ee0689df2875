"""Reading YAML: every error is one sentence with file, line, column and remedy."""

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
    "tag": ("a: !!python/name:os.system x\n", "line 1, column 4", ["is not valid YAML"]),
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
        (b"", "holds no keys"),
        (b"- 1\n- 2\n", "holds no keys"),
    ],
    ids=["latin-1", "binary", "empty", "list"],
)
def test_a_file_that_is_no_yaml_mapping_is_refused(tmp_path, content, part):
    path = tmp_path / "x.yaml"
    path.write_bytes(content)
    assert part in refusal(path)


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    assert "x.yaml: cannot be read" in refusal(tmp_path / "x.yaml")
    assert "is a folder" in refusal(tmp_path)


def test_merge_keys_are_read(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("a: &a {b: 1, c: 2}\nd: {<<: *a, c: 3}\n")
    assert read_yaml(path)["d"] == {"b": 1, "c": 3}
