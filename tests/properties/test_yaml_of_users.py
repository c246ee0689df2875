"""YAML as people write it: numbers, names and layout in every spelling are refused, or mean what a
reader of the file takes them for.
"""

import copy
import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from tests.config.test_config import leaves, put
from tests.properties.full_configurations import CONFIGURATIONS
from tests.properties.guarded import Tried, folder_of_example, guarded
from tests.properties.recorder_files import EITHER, REFUSED, RIGHT
from tests.properties.test_raw_measurements import described
from vibroimpact.campaign.importing.sidecar import Sidecar, read_sidecar
from vibroimpact.config.problems import ConfigError
from vibroimpact.config.reading import check_config, load_config
from vibroimpact.io.signal_files.signals import ImportProblem

PLACEHOLDER = "QQ7QQ"
SAME = object()
# {spelling: (text of a number, what is owed, number that it means, SAME for that number)}
SPELLINGS = {
    "plain": (repr, RIGHT, SAME),
    "plus": (lambda value: f"+{value!r}".replace("+-", "-"), RIGHT, SAME),
    "with a comment": (lambda value: f"{value!r} # of the drawing", RIGHT, SAME),
    "an anchor": (lambda value: f"&here {value!r}", RIGHT, SAME),
    "scientific": (lambda value: f"{float(value):.17e}", EITHER, SAME),
    "without a point": (lambda value: f"{value:e}".replace(".", "").lower(), EITHER, None),
    "without a sign": (lambda value: f"{float(value):.17e}".replace("e+", "e"), EITHER, SAME),
    "capital E": (lambda value: f"{float(value):.17E}", EITHER, SAME),
    "in quotes": (lambda value: f"'{value!r}'", EITHER, SAME),
    "a tag": (lambda value: f"!!float {value!r}", EITHER, SAME),
    "a decimal comma": (lambda value: f"{float(value):.9f}".replace(".", ","), REFUSED, None),
    "a unit": (lambda value: f"{value!r} mm", REFUSED, None),
    "a percent sign": (lambda value: f"{value!r} %", REFUSED, None),
    "a comma behind": (lambda value: f"{value!r},", REFUSED, None),
    "a semicolon behind": (lambda value: f"{value!r};", REFUSED, None),
    "twice": (lambda value: f"{value!r} {value!r}", REFUSED, None),
    "a product": (lambda value: f"2 * {value!r}", REFUSED, None),
    "a fraction": (lambda value: "1/3", REFUSED, None),
    "Fortran": (lambda value: f"{float(value):.9e}".replace("e", "d"), REFUSED, None),
    "a long minus": (lambda value: f"−{abs(value)!r}", REFUSED, None),
    "hexadecimal": (lambda value: "0x1F", EITHER, 31),
    "octal": (lambda value: "010", REFUSED, None),
    "with underlines": (lambda value: "1_000", EITHER, 1000),
    "sexagesimal": (lambda value: "1:30", REFUSED, None),
    "a date": (lambda value: "2012-01-01", REFUSED, None),
    "a version": (lambda value: "1.5.2", REFUSED, None),
    "too large": (lambda value: "1.0e+400", REFUSED, None),
    **{
        word: (lambda value, word=word: word, REFUSED, None)
        for word in ("yes", "no", "on", "off", "true", "False", ".nan", ".inf", "-.Inf", "n/a", "?")
    },
}
NAMES = {
    **dict.fromkeys(
        ["no", "on", "y", "N", "true", "null", "~", "1", "1.0", "1e3", "0x1F", "010", "1:30",
         "'no'", "2012-01-01", "a b", "a: b", "a #b", "#a", "é", "$x$", "=1+1", "a/b", "../a", "-a",
         '"1"', "a'b", "[a]", "*a", "&a", "!a", "%a", "@a", "`a", "<<", "A" * 300], EITHER
    ),
    "left": RIGHT, "b_2": RIGHT, "Nord": RIGHT,
}  # fmt: skip


def _without_space(text):
    return re.sub(r"^(\w+): (?=\d)", r"\1:", text, count=1, flags=re.M)


def _upper(part):
    return part[0].upper()


LAYOUTS = {
    "as it is": (lambda text: text, RIGHT),
    "Windows lines": (lambda text: text.replace("\n", "\r\n"), RIGHT),
    "a mark of UTF-8": (lambda text: "\ufeff" + text, EITHER),
    "marks of a document": (lambda text: f"---\n{text}...\n", EITHER),
    "two documents": (lambda text: f"{text}---\n{text}", REFUSED),
    "no end of line": (lambda text: text.rstrip("\n"), RIGHT),
    "comments": (lambda text: text.replace("\n", "  # x\n"), RIGHT),
    "blank lines": (lambda text: text.replace("\n", "\n\n"), RIGHT),
    "tabs": (lambda text: text.replace("  ", "\t"), REFUSED),
    "hard spaces": (lambda text: text.replace("  ", "\u00a0 "), REFUSED),
    "no space after a colon": (_without_space, EITHER),
    "the last line twice": (lambda text: text + text.rstrip("\n").rsplit("\n", 1)[1], EITHER),
    "capital keys": (lambda text: re.sub(r"^\w", _upper, text, flags=re.M), REFUSED),
    "dashes in keys": (lambda text: re.sub(r"^(\w+)_(\w+:)", r"\1-\2", text, flags=re.M), EITHER),
    "a colon lost": (lambda text: text.replace(":", "", 1), REFUSED),
    "a line less indented": (lambda text: re.sub(r"\n  (?! )", "\n ", text, count=1), EITHER),
}  # fmt: skip


def studies():
    """The content of small configurations."""
    return [copy.deepcopy(CONFIGURATIONS[name]) for name in ("path", "chain", "u_tube", "table")]


KINDS = {
    "study.yaml": (studies, load_config, ConfigError, lambda data: check_config(data, "base")),
    "campaign.yaml": (
        lambda: [described("csv", period_samples=64, transient_periods=1, band_Hz=[5.0, 200.0])],
        read_sidecar,
        ImportProblem,
        Sidecar.model_validate,
    ),
}


def numbers(data):
    """Places of the numbers in nested content, as (dotted place, number)."""
    return [
        (place, value)
        for place, value in leaves(data)
        if isinstance(value, (int, float)) and not isinstance(value, bool)
    ]


def spelled_number(draw, data):
    """(text of the file, what is owed, the content that it means)."""
    place, value = draw(st.sampled_from(numbers(data)))
    spelling = draw(st.sampled_from([*SPELLINGS]))
    write, owed, meant = SPELLINGS[spelling]
    text = write(value)
    if meant is not SAME:
        put(data, place, meant)
    if spelling == "without a point":  # 2.500000e-04 to 2500000e-04
        put(data, place, float(text))
        owed = EITHER
    if spelling == "a decimal comma" or owed == REFUSED:
        put(data, place, value)
    shown = copy.deepcopy(data)
    put(shown, place, PLACEHOLDER)
    return dumped(shown).replace(PLACEHOLDER, text), owed, data, (place, spelling)


def spelled_name(draw, data):
    """The same with one name in every place where it stands."""
    names = sorted({value for _, value in leaves(data) if isinstance(value, str)} & IN_USE)
    name, text = draw(st.sampled_from(names)), draw(st.sampled_from([*NAMES]))
    shown = renamed(data, name, PLACEHOLDER)
    bare = text[1:-1] if text[0] in "'\"" and text[-1] == text[0] else text
    bare = {"null": None, "~": None, "&a": None, "#a": None, "a #b": "a"}.get(bare, bare)
    return dumped(shown).replace(PLACEHOLDER, text), NAMES[text], renamed(data, name, bare), text


IN_USE = {"drive", "tip", "stop", "one", "two", "shaker", "middle", "a", "b", "low", "high"}


def renamed(data, old, new):
    """Content with a name as another, as key and as value."""
    if isinstance(data, dict):
        return {new if key == old else key: renamed(each, old, new) for key, each in data.items()}
    if isinstance(data, list):
        return [renamed(each, old, new) for each in data]
    return new if data == old else data


def laid_out(draw, data):
    """The same with another layout."""
    layout = draw(st.sampled_from([*LAYOUTS]))
    change, owed = LAYOUTS[layout]
    flow = layout in ("as it is", "Windows lines") and draw(st.sampled_from([None, False]))
    text = dumped(data, flow)
    changed = change(text)
    return changed, RIGHT if changed == text else owed, data, layout


def dumped(data, flow=False):
    """Content as YAML in blocks, no line of which is folded."""
    return yaml.safe_dump(
        data, allow_unicode=True, sort_keys=False, width=10**6, default_flow_style=flow
    )


@pytest.mark.parametrize("name", KINDS)
def test_yaml_of_users_is_refused_or_means_what_it_says(name, reliability):
    contents, read, refusal, checked = KINDS[name]
    tried = Tried()

    @given(st.data())
    def check(data):
        content = data.draw(st.sampled_from(contents()))
        how = data.draw(st.sampled_from([spelled_number, spelled_number, spelled_name, laid_out]))
        text, owed, meant, told = how(data.draw, copy.deepcopy(content))
        with folder_of_example() as folder:
            path = Path(folder, name)
            path.write_bytes(text.encode())
            outcome, result = tried.add(guarded(lambda: read(path), refusal, [folder], [name]))
        if outcome == "refused":
            assert owed != RIGHT, (told, result)
            return
        assert owed != REFUSED, (told, result)
        assert result == checked(meant), told

    check()
    reliability.inputs(f"{name}: spellings of numbers and names, layouts", tried)
