"""The code in the documentation: Python runs, configurations are valid, commands exist."""

import os
import re
import subprocess
import sys

import pytest
import yaml
from pydantic import TypeAdapter

from tests.docs.markdown import ROOT, blocks, name, shell_lines
from vibroimpact.config.reading import Config, check_config

TOP_KEYS = {"study", "structure", "excitation", "grid", "record"}  # of a whole configuration
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
RULES = "\n".join(
    file.read_text(encoding="utf-8")
    for file in [
        ROOT / "Snakefile",
        *ROOT.glob("workflow/rules/*.smk"),
        *ROOT.glob("evidence/rules/*.smk"),
        *ROOT.rglob("examples/**/*.smk"),
    ]
)


def example_name(value):
    """The page of an example, for the test's name."""
    return name(value) if hasattr(value, "parts") else None


OWN_STRUCTURE = ("your_structure",)
STRUCTURE = yaml.safe_load((ROOT / "config" / "four_supports.yaml").read_text())["structure"]


@pytest.mark.parametrize(("page", "number", "text"), blocks("python"), ids=example_name)
def test_python_examples_run(page, number, text, tmp_path):
    needed = re.findall(r'"(results/[^"]+)"', text)
    if any(not (ROOT / path).exists() for path in needed):
        pytest.skip(f"needs {', '.join(needed)}, which `make study` writes")
    ran = subprocess.run(
        [sys.executable, "-c", text],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert ran.returncode == 0, ran.stderr


@pytest.mark.parametrize(("page", "number", "text"), blocks("yaml"), ids=example_name)
def test_yaml_examples_are_valid(page, number, text):
    data = yaml.safe_load(text)
    assert isinstance(data, dict)
    if set(data) >= TOP_KEYS:
        check_config(data, name(page))


@pytest.mark.parametrize(
    ("number", "text"),
    [(number, text) for page, number, text in blocks("yaml") if page.stem in OWN_STRUCTURE],
    ids=str,
)
def test_yaml_parts_of_a_structure_are_valid(number, text):
    """A block that shows some sections of a study's configuration: each is valid by itself, or, of
    the structure, over that of an example.
    """
    for key, value in yaml.safe_load(text).items():
        if key == "structure" and "kind" not in value:
            value = {**STRUCTURE, **value}
        TypeAdapter(Config.model_fields[key].annotation).validate_python(value)


def test_there_is_a_whole_configuration_among_the_examples():
    whole = [text for _, _, text in blocks("yaml") if set(yaml.safe_load(text)) >= TOP_KEYS]
    assert whole


def test_make_targets_in_the_pages_exist():
    targets = set(re.findall(r"^([a-z-]+):", MAKEFILE, flags=re.M))
    unknown = {
        (name(page), line)
        for page, line in shell_lines()
        for target in re.findall(r"^make ((?:[a-z-]+)?)(?= |$)", line)
        if target and target not in targets
    }
    assert unknown == set()


def snakemake_targets(line):
    """The targets that a snakemake command asks for: its words that are neither options nor their
    values.
    """
    words = line.split("#")[0].split()
    if not words or not words[0].endswith("snakemake"):
        return []
    words, found = words[1:], []
    while words and "=" not in words[0]:
        word = words.pop(0)
        if word in ("--configfile", "--profile", "--config", "--set-threads"):
            words = words[1:]
        elif not word.startswith("-"):
            found.append(word)
    return found


def test_snakemake_targets_in_the_pages_exist():
    rules = set(re.findall(r"^ *(?:rule|checkpoint) (\w+):", RULES, flags=re.M))
    unknown = {
        (name(page), target)
        for page, line in shell_lines()
        for target in snakemake_targets(line)
        if target.isidentifier() and target.islower() and target not in rules
    }
    assert unknown == set()


def test_a_snakemake_command_is_taken_apart():
    line = ".venv/bin/snakemake -j2 discrepancy --config campaign=FILE model=identified"
    assert snakemake_targets(line) == ["discrepancy"]
    assert snakemake_targets("snakemake --configfile config/a.yaml timing") == ["timing"]


def test_files_named_in_commands_exist():
    missing = {
        (name(page), path)
        for page, line in shell_lines()
        for path in re.findall(
            r"(?<![\w/])((?:config/[\w/]+\.yaml|docs/[\w/]+\.py|workflow/\w+/[\w/]+(?:\.\w+)?))",
            line,
        )
        if not (ROOT / path).exists() and path not in MADE_BY_THE_READER
    }
    assert missing == set()


MADE_BY_THE_READER = {"config/mine.yaml", "config/one_mass.yaml", "config/x.yaml"}
