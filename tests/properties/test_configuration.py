"""Damaged configurations: refused with their place, or read back equal; damaged YAML files:
refused with the file's name, or read as PyYAML reads it.
"""

import re
from pathlib import Path

import yaml
from hypothesis import given
from hypothesis import strategies as st

from tests.properties.damage import damaged_bytes, damaged_mapping
from tests.properties.guarded import Tried, folder_of_example, guarded
from vibroimpact.config.problems import ConfigError
from vibroimpact.config.reading import Config, check_config, load_config, read_yaml
from vibroimpact.study.cases import all_cases

CONFIG = Path(__file__).parents[2] / "config"
FILES = sorted(
    file for folder in (".", "examples", "reference") for file in (CONFIG / folder).glob("*.yaml")
)
CONFIGURATIONS = [yaml.safe_load(file.read_text(encoding="utf-8")) for file in FILES]
KEYS = "|".join(Config.model_fields)
PLACE = re.compile(rf"mine.yaml: (({KEYS})[\[. ]|unknown key '|the key )")


def test_damaged_configurations_are_refused_or_right(reliability):
    tried = Tried()

    @given(st.integers(0, len(FILES) - 1).flatmap(lambda n: damaged_mapping(CONFIGURATIONS[n])))
    def check(data):
        outcome = tried.add(guarded(lambda: check_config(data, "mine.yaml"), ConfigError, []))
        if outcome[0] == "right":
            config = outcome[1]
            assert check_config(config.model_dump(mode="json"), "again") == config
            guarded(lambda: all_cases(config.grid), ConfigError, [])
        else:
            assert all(map(PLACE.match, outcome[1].splitlines())), outcome[1]

    check()
    reliability.inputs("configurations with one to three keys damaged", tried)


BOMB = b"{k0: &k0 [x, x, x]" + b"".join(
    b", k%d: &k%d [%s]" % (i, i, b"*k%d, " % (i - 1) * 9) for i in range(1, 12)
)
YAML_PARTS = (
    *(b"*a", b"&a ", b"<<: *a\n", b"{a: *a}", b"!!python/object/apply:os.system [ls]"),
    *(b"!!int x", b"\t", b"\xb5", b"\0", b"\xef\xbb\xbf", b"---\n", b"...\n", b"%YAML 9.9\n"),
    *(b"[" * 2000, b"{a: " * 2000, b"- " * 2000, b"'", b'"', b'"\\UFFFFFFFF"', b"#", b": "),
    *(b"|9\n", b"2012-13-45", b"010", b"1:30", b"9" * 5000, b"~", b"yes", b".nan", b"1e400"),
    *(b"\r", b"\x85", b"? [a]\n: 1\n", BOMB + b"}"),
)
ENCODINGS = ("utf-8", "utf-8", "utf-8", "utf-8-sig", "utf-16", "utf-32", "utf-16-be", "latin-1")


@st.composite
def damaged_yaml(draw):
    """The bytes of a configuration with parts of YAML put in, cut, or in another encoding."""
    text = FILES[draw(st.integers(0, len(FILES) - 1))].read_text(encoding="utf-8")
    lines = [line.encode(draw(st.sampled_from(ENCODINGS[:3]))) for line in text.splitlines(True)]
    how = draw(st.sampled_from(["line", "part", "bytes", "encoding"]))
    if how == "encoding":
        return ("# \xb5\n" + text).encode(draw(st.sampled_from(ENCODINGS)))
    if how == "bytes":
        return draw(damaged_bytes(text.encode()))
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(lines) - 1))
        part = draw(st.sampled_from(YAML_PARTS))
        key = lines[at].split(b":")[0]
        end = b"\n" * (not part.endswith(b"\n"))
        lines[at] = key + b": " + part + end if how == "part" else lines[at] + part + end
    return b"".join(lines)


def test_damaged_yaml_is_refused_or_read_as_it_stands(reliability):
    tried = Tried()

    @given(damaged_yaml())
    def check(content):
        with folder_of_example() as folder:
            path = folder / "mine.yaml"
            path.write_bytes(content)
            read = guarded(lambda: read_yaml(path), ConfigError, [folder], ["mine.yaml: "])
            tried.add(guarded(lambda: load_config(path), ConfigError, [folder], ["mine.yaml: "]))
        if read[0] == "right":
            assert repr(read[1]) == repr(yaml.safe_load(content))

    check()
    reliability.inputs("YAML files: encodings, tags, aliases, nesting, damaged bytes", tried)
