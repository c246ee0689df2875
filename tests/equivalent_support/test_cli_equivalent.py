"""The command `vibroimpact equivalent`: what it prints and writes, and its exit code."""

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

from tests.support.exported_springs import nastran
from tests.support.study_tables import disputed_study, k_law, made_up_study
from vibroimpact.cli import main
from vibroimpact.equivalent_support.command import FORMATS
from vibroimpact.io.records import write_table
from vibroimpact.study.equivalent_table import EQUIVALENT_COLUMNS

CONFIG = Path(__file__).parents[2] / "config" / "study.yaml"
CASE = ("--load", 4, "--gap", 1e-4)


@pytest.fixture
def run(capsys):
    """A command, as (exit code, output, errors)."""

    def run(*arguments):
        code = main(["equivalent", *map(str, arguments)])
        return code, *capsys.readouterr()

    return run


def study_in_results(base, name, model):
    """The folder of a study whose k is a power of load over gap."""
    folder = base / "results" / name
    folder.mkdir(parents=True)
    return made_up_study(folder, model)


@pytest.fixture
def study(tmp_path, study_model):
    return study_in_results(tmp_path, "made_up", study_model)


def test_the_answer_is_printed_as_a_table(run, study):
    code, output, errors = run(study, *CASE)
    assert (code, errors) == (0, "")
    assert output.startswith(
        "Study 'made_up': equivalent support at 4 N RMS and a gap of 0.1 mm (load over gap 4e+04"
        " N/m)\n\nGroup 'all' (left, right), along y; values per support\n"
    )
    assert f"k = {k_law(4e4):.4g} N/m" in output and "methods: agree" in output
    assert "A case of the study: 4 N RMS at 0.1 mm." in output
    assert "The methods agree on k from 6.67e+03 to 8e+04 N/m of load over gap." in output


def test_json_and_csv_hold_the_same_numbers(run, study):
    values = json.loads(run(study, *CASE, "--json")[1])
    (row,) = csv.DictReader(io.StringIO(run(study, *CASE, "--csv")[1]))
    k = values["groups"][0]["k"]
    assert k["value"] == float(row["k_N_per_m"]) == pytest.approx(k_law(4e4))
    assert (k["low"], k["high"]) == (float(row["k_low"]), float(row["k_high"]))


def test_a_study_is_found_by_its_name_in_results(run, tmp_path, monkeypatch, study_model):
    study_in_results(tmp_path, "mine", study_model)
    monkeypatch.chdir(tmp_path)
    assert run("mine", *CASE)[0] == 0


def test_outside_the_grid_is_a_sentence_and_code_1(run, study):
    code, output, errors = run(study, "--load", 400, "--gap", 1e-4)
    assert (code, output) == (1, "")
    assert "nothing is extrapolated" in errors and "Traceback" not in errors


def test_what_is_not_resolved_gives_code_1_and_no_file(run, study, tmp_path):
    code, output, errors = run(study, "--load", 1, "--gap", 3e-4)
    assert code == 1 and "k   unresolved" in output and "no method resolves k" in errors
    path = tmp_path / "out.bdf"
    code, output, errors = run(study, "--load", 1, "--gap", 3e-4, "--export", "nastran", path)
    assert (code, output) == (1, "") and errors.startswith("nothing to export")
    assert not path.exists()


def test_methods_that_differ_give_code_1_until_one_is_taken(run, tmp_path, study_model):
    case = (disputed_study(tmp_path, study_model), *CASE)
    code, output, errors = run(*case)
    assert code == 1 and "no recommended value: the methods differ" in output
    assert "To take the value of one method: --anyway lscf, ods or broadband" in errors
    path = tmp_path / "out"
    assert run(*case, "--export", "nastran", path)[0] == 1 and not path.exists()
    for form in FORMATS:
        code, output, errors = run(*case, "--anyway", "broadband", "--export", form, path)
        assert (code, errors) == (0, "")
        head = " ".join(path.read_text().replace("\n", " ").split())[:250].replace("$ ", "")
        assert "WARNING" in head or '"warnings"' in head, form


def test_an_upper_bound_is_exported_as_a_sentence(run, tmp_path, study_model):
    study = made_up_study(tmp_path, study_model)
    text = "k < 2.45 kN/m: the tube touches nothing"
    row = dict.fromkeys(EQUIVALENT_COLUMNS, np.nan) | {"contact_fraction": 0.0, "flag": ""}
    row |= {"gap_m": 1e-4, "load_rms_N": 1.0, "group": "all", "direction": "y", "k_bound": 2.45e3}
    row |= {"agreement_k": "unresolved", "agreement_c": "unresolved"}
    write_table([row | {"reason_k": text, "reason_c": text}], study / "equivalent.csv")
    for form in FORMATS:
        path = tmp_path / "out"
        arguments = (study, "--load", 1, "--gap", 1e-4, "--export", form, path)
        assert run(*arguments)[::2] == (0, ""), form
        words = [word for word in path.read_text().split() if word not in ("$", "**", "#", "!")]
        sentence = f"no spring along y at left, right: per support {text}"
        assert sentence in " ".join(words), form


def test_the_export_holds_the_answer(run, study, tmp_path):
    path = tmp_path / "out.bdf"
    options = ("--export", "nastran", path, "--points", "one", "--unit", "mm", "--across", "none")
    code, output, errors = run(study, *CASE, *options)
    assert (code, errors) == (0, "") and "k = " in output
    place, stiffness, _ = nastran(path.read_text())["left"]
    assert place == pytest.approx([-300.0, 0.0, 350.0])
    assert stiffness[1, 1] == pytest.approx(1.0e-3 * k_law(4e4)) and stiffness[0, 0] == 0.0


@pytest.mark.parametrize(
    "arguments, part",
    [
        ((), "name a study"),
        (("nowhere",), "'nowhere' is no finished study"),
        (("--estimate",), "--estimate needs no study and a configuration"),
        (("--estimate", "--config", "nowhere.yaml"), "nowhere.yaml"),
    ],
)
def test_a_wrong_call_is_a_sentence(run, arguments, part):
    code, output, errors = run(*arguments, "--load", 1, "--gap", 1e-4)
    assert (code, output) == (1, "") and part in errors and "Traceback" not in errors


def test_a_misspelled_study_lists_those_there_are(run, tmp_path, monkeypatch, study_model):
    monkeypatch.chdir(tmp_path)
    assert "Run `snakemake -j2 --configfile FILE`" in run("mein", *CASE)[2]
    for name in ("mine", "other"):
        study_in_results(tmp_path, name, study_model)
    assert "Did you mean mine? There are: mine, other" in run("mein", *CASE)[2]
    assert "is there. There are: mine, other" in run("xyz", *CASE)[2]


def test_a_gap_in_millimetres_is_recognised(run, study):
    code, output, errors = run(study, "--load", 4, "--gap", 0.1)
    assert (code, output) == (1, "")
    assert "gaps are in metres, 0.1 mm is 0.0001" in errors
    errors = run("--estimate", "--config", CONFIG, "--load", 5, "--gap", 0.25)[2]
    assert "gaps are in metres, 0.25 mm is 0.00025" in errors


def test_an_unknown_format_and_a_missing_folder_are_sentences(run, study, tmp_path):
    assert "format 'ansys' is none of nastran" in run(study, *CASE, "--export", "ansys", "x")[2]
    (tmp_path / "file").write_text("")
    code, _, errors = run(study, *CASE, "--export", "csv", tmp_path / "file" / "x.csv")
    assert code == 1 and "cannot be written" in errors


def test_a_study_without_its_model_is_a_sentence(run, study):
    (study / "model.nc").unlink()
    code, _, errors = run(study, *CASE)
    assert code == 1 and "give the study's configuration with --config FILE" in errors
    assert run(study, *CASE, "--config", CONFIG)[0] == 0


def test_the_estimate_needs_no_results(run, tmp_path):
    path = tmp_path / "out.csv"
    case = ("--config", CONFIG, "--load", 5, "--gap", 0.25e-3)
    code, output, errors = run("--estimate", *case, "--export", "csv", path)
    assert (code, errors) == (0, "")
    assert output.startswith("Estimate without a simulation for 'gv_local'")
    assert "This is an estimate from a law, not a result" in output
    assert len(path.read_text().splitlines()) == 1 + 2 * 10
