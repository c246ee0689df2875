"""The folder of a study of one's own, as `vibroimpact new` lays it out from a checkout."""

import os
import re
from pathlib import Path

import pytest
import yaml

import vibroimpact
from tests.support.snakemake_runs import told_by
from vibroimpact.cli import main
from vibroimpact.config.reading import load_config
from vibroimpact.study.folder import shared_files
from vibroimpact.study.folder.new_study import NewStudyError, files_named, new_study

ROOT = Path(__file__).parents[2]


def test_the_default_study_is_laid_out_unchanged(tmp_path):
    files = new_study(tmp_path / "mine")
    assert [str(file) for file in files] == [
        ".gitignore",
        "README.md",
        "Snakefile",
        "config/study.yaml",
        "profiles/default/config.yaml",
        "profiles/shared_folder/config.yaml",
        "profiles/slurm/config.yaml",
    ]
    laid_out = (tmp_path / "mine" / "config" / "study.yaml").read_bytes()
    assert laid_out == (ROOT / "config" / "study.yaml").read_bytes()


def test_the_readme_names_version_example_and_results(tmp_path):
    new_study(tmp_path, "smoke")
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert vibroimpact.__version__ in text and "`smoke`" in text and "results/smoke" in text
    assert re.findall(r"\{\w+\}", text) == []


@pytest.mark.parametrize("example", shared_files.configurations())
def test_every_example_can_be_started_from(tmp_path, example, monkeypatch):
    new_study(tmp_path, example)
    monkeypatch.chdir(tmp_path)  # files that a configuration names are below its folder
    load_config("config/study.yaml")


def test_every_configuration_of_the_repository_is_an_example():
    files = [*ROOT.glob("config/*.yaml"), *ROOT.glob("config/examples/*.yaml")]
    assert sorted(shared_files.configurations()) == sorted(file.stem for file in files)


def test_files_that_a_configuration_names_are_found(tmp_path):
    (tmp_path / "bench").mkdir()
    (tmp_path / "bench" / "mass.mtx").touch()
    data = {"structure": {"mass": "bench/mass.mtx", "points": [{"x": 1}, "bench"]}, "study": "a"}
    assert list(files_named(data, tmp_path)) == [Path("bench/mass.mtx")]


def test_a_folder_that_holds_something_is_refused_untouched(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(NewStudyError, match=r"is not empty, it holds notes\.txt: give a folder"):
        new_study(tmp_path)
    assert [file.name for file in tmp_path.rglob("*")] == ["notes.txt"]


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path):
    (tmp_path / "mine").write_text("mine")
    with pytest.raises(NewStudyError, match="is a file"):
        new_study(tmp_path / "mine")
    with pytest.raises(NewStudyError, match="can not be written"):
        new_study(tmp_path / "mine" / "below")


def test_an_unknown_example_lists_those_there_are(tmp_path, capsys):
    assert main(["new", str(tmp_path / "mine"), "--example", "smok"]) == 1
    told = capsys.readouterr().err
    assert "did you mean smoke?" in told and "study, " in told and "four_supports" in told
    assert not (tmp_path / "mine").exists()


def test_a_copy_without_workflow_says_how_to_install(monkeypatch, tmp_path):
    monkeypatch.setattr(shared_files, "PACKAGE", tmp_path / "src" / "vibroimpact")
    with pytest.raises(FileNotFoundError, match="install it again"):
        shared_files.workflow_snakefile()


def test_own_rules_go_below_the_workflow(tmp_path):
    new_study(tmp_path / "mine", "smoke")
    snakefile = tmp_path / "mine" / "Snakefile"
    own = 'rule mine:\n    output:\n        f"{RESULTS}/mine.txt",\n    shell:\n        "exit 1"\n'
    snakefile.write_text(snakefile.read_text() + own)
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src")}
    told = told_by(tmp_path / "mine", "--dry-run", "mine", env=environment)
    assert "results/smoke/mine.txt" in told


def test_the_profile_of_a_study_is_valid_yaml(tmp_path):
    new_study(tmp_path)
    profile = yaml.safe_load((tmp_path / "profiles" / "default" / "config.yaml").read_text())
    assert profile["rerun-incomplete"] is True
