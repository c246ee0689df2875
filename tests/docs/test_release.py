"""What a release states in several places, and what conda, containers and the workflow catalogue
read.
"""

import re
import tomllib

import pytest
import yaml

import vibroimpact
from tests.docs.markdown import ROOT
from tests.support.snakemake_runs import told_by

CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
ENVIRONMENT = yaml.safe_load((ROOT / "environment.yml").read_text(encoding="utf-8"))
CONTAINERFILE = (ROOT / "Containerfile").read_text(encoding="utf-8")
CONDA_NAMES = {"snakemake-minimal": "snakemake"}  # conda's name: that of the package index


def pins_of(file):
    """{lower-case name: version} of a file of requirements or a lock."""
    text = (ROOT / file).read_text(encoding="utf-8")
    return {name.lower(): version for name, version in re.findall(r"^(\S+)==(\S+)", text, re.M)}


def environment_pins():
    """{lower-case name: version} of environment.yml, those that pip installs among them."""
    *conda, pip = ENVIRONMENT["dependencies"]
    pins = dict(entry.split("=") for entry in conda if "=" in entry)
    pins |= dict(entry.split("==") for entry in pip["pip"] if "==" in entry)
    return {CONDA_NAMES.get(name, name): version for name, version in pins.items()}


def test_the_citation_has_version_and_date_of_the_changelog():
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    version, date = re.search(r"^## (\S+) \((\S+)\)", changelog, re.M).groups()
    assert CITATION["version"] == vibroimpact.__version__ == version
    assert str(CITATION["date-released"]) == date


def test_the_version_stands_in_one_place_of_the_build():
    assert PROJECT["project"]["dynamic"] == ["version"]
    assert PROJECT["tool"]["setuptools"]["dynamic"]["version"] == {
        "attr": "vibroimpact.__version__"
    }


def test_citation_and_build_name_the_same_license():
    assert CITATION["license"] == PROJECT["project"]["license"] == "BSD-3-Clause"
    assert (ROOT / PROJECT["project"]["license-files"][0]).is_file()


def test_conda_has_the_versions_of_the_requirements():
    pins = environment_pins()
    python = pins.pop("python")
    assert pins == pins_of("requirements.in") and len(pins) > 20
    assert PROJECT["project"]["requires-python"] == f">={python}"


@pytest.mark.parametrize("lock", sorted(ROOT.glob("requirements-*.lock")), ids=lambda at: at.stem)
def test_a_lock_holds_what_it_adds_to_the_base(lock):
    first, *rest = lock.read_text(encoding="utf-8").splitlines()
    names = [line.split("==")[0] for line in rest if re.match(r"\S+==", line)]
    base = pins_of("requirements.lock")
    wanted = pins_of(lock.with_suffix(".in").name)
    assert first == "-r requirements.lock" and names and not set(names) & set(base)
    assert {name.replace("_", "-"): version for name, version in wanted.items()}.items() <= (
        pins_of(lock.name).items()
    )


def test_files_of_requirements_pin_a_package_alike():
    pins = [pins_of(file.name) for file in ROOT.glob("requirements*.in")]
    versions = {(name, version) for each in pins for name, version in each.items()}
    assert len(versions) == len({name for name, _ in versions}) > 30


def test_every_dependency_of_the_wheel_is_pinned():
    names = {re.match(r"[\w-]+", entry)[0].lower() for entry in PROJECT["project"]["dependencies"]}
    assert names - set(pins_of("requirements.in")) == set() and len(names) > 5


def test_the_container_installs_pinned_and_drops_root():
    assert "--require-hashes --requirement requirements.lock" in CONTAINERFILE
    assert re.search(r"^USER [1-9]\d*$", CONTAINERFILE, re.M)
    assert CONTAINERFILE.index("\nUSER ") < CONTAINERFILE.index("\nENTRYPOINT ")
    python = re.search(r"^FROM python:(\d+\.\d+)-slim$", CONTAINERFILE, re.M)[1]
    assert python == ENVIRONMENT["dependencies"][0].partition("=")[2]


def test_the_context_of_the_container_holds_what_is_copied():
    ignored = (ROOT / ".containerignore").read_text(encoding="utf-8").split()
    copied = {name for name in copied_to_container() if name != "./"}
    assert {f"!{name}" for name in copied} <= set(ignored) and ignored[0] == "*"
    assert all((ROOT / name).exists() for name in copied)


def copied_to_container():
    """The files and folders that the Containerfile copies."""
    lines = re.findall(r"^COPY (.*) \S+$", CONTAINERFILE, re.M)
    return [name for line in lines for name in line.split()]


def test_the_workflow_catalogue_finds_what_it_asks_for():
    # Its documentation: these three files, rules that end in .smk, both words in the README.
    usage = yaml.safe_load((ROOT / ".snakemake-workflow-catalog.yml").read_text())["usage"]
    assert set(usage) == {"mandatory-flags", "software-stack-deployment"}
    assert (ROOT / "workflow" / "Snakefile").is_file() and (ROOT / "config/README.md").is_file()
    assert {file.suffix for file in (ROOT / "workflow" / "rules").iterdir()} == {".smk"}
    readme = (ROOT / "README.md").read_text(encoding="utf-8").lower()
    assert "snakemake" in readme


def test_every_configuration_is_named_in_their_readme():
    text = (ROOT / "config" / "README.md").read_text(encoding="utf-8")
    config = ROOT / "config"
    files = [*config.glob("*.yaml"), *config.glob("examples/*.yaml")]
    names = [file.relative_to(config).as_posix() for file in files]
    assert [name for name in names if f"`{name}`" not in text] == []


def test_workflow_is_planned_as_a_module_of_another(tmp_path):
    # As tools for deployment write it: a Snakefile of a few lines, the configuration beside it.
    (tmp_path / "config.yaml").write_bytes((ROOT / "config" / "smoke.yaml").read_bytes())
    (tmp_path / "Snakefile").write_text(
        'configfile: "config.yaml"\n\nmodule tube:\n    snakefile:\n'
        f'        "{ROOT}/workflow/Snakefile"\n    config:\n        config\n\n'
        "use rule * from tube\n"
    )
    told = told_by(tmp_path, "--dry-run", "--quiet", "rules")
    assert len(set(re.findall(r"^_simulate_from_\S+ +1$", told, re.M))) == 3
    assert re.search(r"^all +1$", told, re.M)
