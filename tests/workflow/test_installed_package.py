"""The package as others get it: archives built, the wheel installed, a study laid out and planned.

The environment has the dependencies of this one and the installed wheel, and nothing of this
checkout. Its path and that of the study hold a space and a letter outside ASCII.
"""

import csv
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from collections import Counter
from pathlib import Path

import pytest

import vibroimpact
from tests.docs.test_release import copied_to_container

ROOT = Path(__file__).parents[2]
BUILT_WITH = "setuptools>=77.0.3"  # as pyproject.toml says
NOT_COPIED = (".git", ".venv*", "results", "build", "_build", "generated", "__pycache__", ".*cache")
CASE = {"load_rms_N": 4.0, "gap_m": 2.8886e-4, "seed": 1}  # one of the small study


def run(*command, **options):
    """The finished process of a command that must succeed."""
    done = subprocess.run(
        [str(part) for part in command],
        capture_output=True,
        text=True,
        env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        | options.pop("env", {}),
        **options,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done


@pytest.fixture(scope="module")
def build_tools(tmp_path_factory):
    """A folder with the setuptools that pyproject.toml asks for."""
    folder = tmp_path_factory.mktemp("tools")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    pip += ["--retries", "0", "--timeout", "10", "--target", folder, BUILT_WITH]
    fetched = subprocess.run([str(part) for part in pip], capture_output=True, text=True)
    if fetched.returncode != 0:
        pytest.skip(f"{BUILT_WITH} can not be fetched: no package index, so no wheel is built")
    return folder


def build(kind, source, target, tools):
    """The archive that a hook of the build backend makes of a source tree: "wheel" or "sdist"."""
    target.mkdir(exist_ok=True)
    call = f"from setuptools import build_meta; build_meta.build_{kind}({str(target)!r})"
    run(sys.executable, "-c", call, cwd=source, env={"PYTHONPATH": str(tools)})
    (archive,) = target.iterdir()
    return archive


@pytest.fixture(scope="module")
def archives(tmp_path_factory, build_tools):
    """(wheel built from this tree, source archive, wheel built from the source archive)."""
    folder = tmp_path_factory.mktemp("archives")
    tree = folder / "tree"
    ignore = shutil.ignore_patterns(*NOT_COPIED)
    shutil.copytree(ROOT, tree, symlinks=True, ignore=ignore)
    source = build("sdist", tree, folder / "source", build_tools)
    safe = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}  # 3.11.4 and newer
    with tarfile.open(source) as archive:
        archive.extractall(folder / "unpacked", **safe)
    (unpacked,) = (folder / "unpacked").iterdir()
    wheel = build("wheel", tree, folder / "wheel", build_tools)
    return wheel, source, build("wheel", unpacked, folder / "wheel_of_source", build_tools)


@pytest.fixture(scope="module")
def environment(tmp_path_factory, archives):
    """The folder of an environment in which the wheel is installed."""
    folder = tmp_path_factory.mktemp("installed") / "Étude du tube" / "environment"
    run(sys.executable, "-m", "venv", "--without-pip", folder)
    python = folder / "bin" / "python"
    packages = run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))")
    dependencies = {sysconfig.get_path("purelib"), sysconfig.get_path("platlib")}
    Path(packages.stdout.strip(), "dependencies.pth").write_text("\n".join(sorted(dependencies)))
    install = [sys.executable, "-m", "pip", "--python", python, "install", "--no-deps"]
    run(*install, "--no-index", "--quiet", archives[0])
    return folder


@pytest.fixture(scope="module")
def study(environment):
    """A function that lays out a study and returns its folder."""

    def lay_out(name, *arguments):
        folder = environment.parent / name
        run(environment / "bin" / "vibroimpact", "new", folder, *arguments, cwd=environment.parent)
        return folder

    return lay_out


def snakemake(environment, folder, *arguments):
    """The output of a snakemake of the environment, started in a study's folder."""
    command = [environment / "bin" / "python", "-m", "snakemake", *arguments]
    done = run(*command, cwd=folder)
    return done.stdout + done.stderr


def planned(output):
    """{rule: number of jobs} of the table of a dry run, without its total. Rules of batches, as
    _simulate_from_0.5, count as one.
    """
    counts = Counter()
    for rule, count in dict(re.findall(r"^([\w.]+) +(\d+)$", output, flags=re.M)).items():
        counts[rule.split("_from_")[0]] += int(count)
    counts.pop("total", None)
    return dict(counts)


def names(archive):
    """The names of the files in a wheel."""
    with zipfile.ZipFile(archive) as wheel:
        return set(wheel.namelist())


def k_of_case(rows, load_rms_N, gap_m, seed):
    """{method: equivalent stiffness in N/m} of one case of the table of a study."""
    case = {"load_rms_N": load_rms_N, "gap_m": gap_m, "seed": seed}
    return {
        row["method"]: float(row["k_N_per_m"])
        for row in rows
        if {key: float(row[key]) for key in case} == case
    }


def k_in_process(load_rms_N, gap_m, seed):
    """{method: equivalent stiffness in N/m} of one case, without workflow, files and wheel."""
    config = vibroimpact.load_config(ROOT / "config" / "smoke.yaml")
    record = vibroimpact.simulate_case(config, load_rms_N, gap_m, seed)
    found = vibroimpact.identify_support(config, record)
    return {method: estimate.k for method, estimate in found.items()}


def test_the_wheel_brings_workflow_configurations_and_examples(archives):
    shared = {
        str(file.relative_to(ROOT))
        for folder in ("workflow", "config")
        for file in (ROOT / folder).rglob("*")
        if file.is_file() and "__pycache__" not in file.parts
    }
    shared -= {  # for clones
        "workflow/lock_additions.py",
        "workflow/put_library_on_path.py",
        "workflow/remove_study.py",
    }
    assert "workflow/scripts/simulate.py" in shared and "config/study.yaml" in shared
    shared |= {"Snakefile", "examples/f16/records.py", "examples/f16/structure.yaml"}
    missing = {f"vibroimpact/share/{name}" for name in shared} - names(archives[0])
    assert missing == set()


def test_the_source_archive_makes_the_same_wheel(archives):
    wheel, _, of_source = archives
    assert names(wheel) == names(of_source)


def test_the_source_archive_holds_tests_and_locks(archives):
    with tarfile.open(archives[1]) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    there = {str(file.relative_to(ROOT)) for file in (ROOT / "tests").rglob("*.py")}
    assert there - held == set() and len(there) > 100
    assert {"requirements.lock", "CITATION.cff", "Makefile", "profiles/default/config.yaml"} <= held


def test_rules_find_configurations_in_an_installed_package():
    # A path that begins with config/ is one of the user's study: the repository's configurations
    # are below CONFIGURATIONS.
    rules = (ROOT / "workflow" / "rules").glob("*.smk")
    literal = [file.name for file in rules if re.search(r"""["']config/""", file.read_text())]
    assert literal == []


def test_the_container_copies_all_that_the_wheel_needs(tmp_path, archives, build_tools):
    (tmp_path / "context").mkdir()
    for name in copied_to_container():
        source, target = ROOT / name, tmp_path / "context" / name
        ignore = shutil.ignore_patterns(*NOT_COPIED)
        if source.is_dir():
            shutil.copytree(source, target, symlinks=True, ignore=ignore)
        else:
            shutil.copy(source, target)
    wheel = build("wheel", tmp_path / "context", tmp_path / "wheel", build_tools)
    assert names(wheel) == names(archives[0])


@pytest.mark.slow
def test_the_wheel_plans_a_study_as_the_checkout_does(environment, study, tmp_path):
    told = snakemake(environment, study("mine", "--example", "smoke"), "--dry-run")
    assert str(ROOT / "src") not in told
    jobs = planned(told)
    assert jobs["all"] == jobs["_basis"] == 1
    assert jobs["_simulate"] == jobs["_spectra"] == 3  # one for each load
    files = ["--snakefile", ROOT / "Snakefile", "--configfile", ROOT / "config" / "smoke.yaml"]
    command = [sys.executable, "-m", "snakemake", "--dry-run", *files]
    here = run(*command, cwd=tmp_path)
    assert planned(here.stdout + here.stderr) == jobs


@pytest.mark.slow
def test_a_broken_configuration_is_named_with_its_line(environment, study):
    folder = study("broken", "--example", "smoke")
    (folder / "config" / "study.yaml").write_text("study: mine\nseed: [1\nspectra: {}\n")
    command = [environment / "bin" / "python", "-m", "snakemake", "--dry-run"]
    told = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert told.returncode == 1
    last = told.stderr.strip().splitlines()[-1]
    assert last.startswith("config/study.yaml: line 3, column 8: the list that [ opens in line 2")


@pytest.mark.slow
def test_the_wheel_runs_the_small_study_to_its_tables(environment, study):
    folder = study("à moi", "--example", "smoke")
    snakemake(environment, folder, "-j2", "--until", "_consistency")
    with (folder / "results" / "smoke" / "consistency.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * 2 * 2 * 8  # loads, gaps, seeds, methods
    assert k_of_case(rows, **CASE) == pytest.approx(k_in_process(**CASE), rel=1e-12, nan_ok=True)
    moved = folder.rename(folder.with_name("déplacé"))
    assert planned(snakemake(environment, moved, "-n", "--until", "_consistency")) == {}
    library = next(environment.glob("lib/*/site-packages/vibroimpact"))
    with (library / "identify" / "spectra" / "welch.py").open("a") as file:
        file.write("\n# an edit\n")
    again = planned(snakemake(environment, moved, "-n", "--until", "_consistency"))
    assert "_spectra" in again and not {"_basis", "_simulate"} & set(again)
