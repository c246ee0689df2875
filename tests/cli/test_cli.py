"""The command line: what is printed, and the exit code."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

import vibroimpact
from vibroimpact.campaign.file import Channel, Level, campaign_dataset, write_campaign
from vibroimpact.cli import main
from vibroimpact.excitation.random_force import band_limited_noise

ROOT = Path(__file__).parents[2]
STUDY = ROOT / "config" / "study.yaml"


@pytest.fixture
def run(capsys):
    """A command, as (exit code, output, errors)."""

    def run(*arguments):
        code = main([str(argument) for argument in arguments])
        return code, *capsys.readouterr()

    return run


def test_a_valid_study_is_described_in_one_line(run):
    code, output, errors = run("check", STUDY)
    assert (code, errors) == (0, "")
    assert output == (
        f"{STUDY}: study 'gv_local': structure of kind u_tube, 2 supports, 0 elements, excitation"
        " of kind band_limited, 288 cases with identification\n"
    )  # 24 loads x 3 gaps x 4 seeds


def test_properties_of_what_is_named_are_shown(run, tmp_path):
    data = yaml.safe_load(STUDY.read_text())
    data["structure"]["material"] = {"name": "stainless_steel_316", "temperature_C": 300}
    data["structure"]["fluid"] = [
        {"kind": "inside", "density_kg_per_m3": 700.0},
        {"kind": "outside", "name": "water", "temperature_C": 20.0},
    ]
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(data))
    code, output, errors = run("check", path)
    assert (code, errors) == (0, "")
    assert (
        "kind u_tube of stainless_steel_316 at 300 °C (E 176 GPa, nu 0.3, 8000 kg/m3) with water"
        " at 20 °C outside (998.2 kg/m3, 0.001002 Pa s), 2 supports" in output
    )


def test_all_problems_of_a_study_are_printed(run, tmp_path):
    data = yaml.safe_load(STUDY.read_text())
    data["spectra"]["overlp"] = 0.5
    data["grid"]["gap_m"] = [-1.0]
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(data))
    code, output, errors = run("check", path)
    assert (code, output) == (1, "")
    assert "unknown key 'overlp' in spectra" in errors and "grid.gap_m[0] = -1.0" in errors


def test_a_wrong_key_hides_no_problem_of_the_model(run, tmp_path):
    data = yaml.safe_load(STUDY.read_text())
    data["spectra"]["overlp"] = 0.5
    data["structure"]["theory"] = "timoshenk"
    data["supports"][0]["stiffness_N_per_m"] = 1.0e12
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(data))
    code, output, errors = run("check", path)
    assert (code, output) == (1, "")
    for part in ("unknown key 'overlp'", "theory = 'timoshenk'", "contact stiffness 2e+11"):
        assert part in errors


@pytest.mark.parametrize(
    ("name", "content", "part"),
    [
        ("nowhere.yaml", None, "cannot be read"),
        ("broken.yaml", b"a: [1\nb: 2\n", "line 2, column 2"),
        ("binary.yaml", b"\x7fELF\0\0", "is a binary file"),
        ("latin.yaml", b"a: \xe9\n", "not UTF-8"),
        ("text.nc", b"no netCDF", "can not be read"),
        ("no_name", b"\x89HDF\r\n\x1a\n", "can not be read"),
        ("nowhere.nc", None, "cannot be read"),
    ],
)
def test_unreadable_file_is_reported_in_a_sentence(run, tmp_path, name, content, part):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    code, output, errors = run("check", path)
    assert (code, output) == (1, "")
    assert errors.startswith(f"{path}: ") and part in errors and "Traceback" not in errors


def test_an_overlay_is_a_campaign(run, tmp_path):
    data = yaml.safe_load(STUDY.read_text())
    data["overlay"]["campaign"] = str(STUDY)
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(data))
    code, output, errors = run("check", path)
    assert (code, output) == (1, "")
    assert f"overlay.campaign: {STUDY}: can not be read as netCDF" in errors


def test_missing_matrices_are_named(run, tmp_path):
    data = {
        "study": "mine",
        "structure": {
            "kind": "matrices",
            "mass": "no/mass.mtx",
            "stiffness": "no/stiffness.mtx",
            "points": {"tip": {"x": 0}},
        },
        "excitation": {"kind": "none"},
        "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3]},
        "record": {"duration_s": 20.0},
    }
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(data))
    code, _, errors = run("check", path)
    assert code == 1 and errors.startswith(f"{path}: no/mass.mtx: no such file")


@pytest.fixture
def campaign(tmp_path):
    """The path of a campaign with two levels of a force and responses that follow it."""
    noise = band_limited_noise(np.random.default_rng(1), 16384, 256.0, (5.0, 60.0))
    force = noise * np.array([1.0, 3.0])[:, None, None]
    response = 0.5 * force + 0.1 * np.roll(force, 1, axis=-1)
    channel = Channel("a1", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), "m s-2", "acceleration")
    drive = Channel("drive", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), "N", "generic")
    path = tmp_path / "campaign.nc"
    dataset = campaign_dataset(
        force, response, [channel], [drive], [Level("low", 1e-3), Level("high", 1e-3)], 256.0
    )
    write_campaign(dataset, path)
    return path


def test_a_campaign_is_described(run, campaign):
    code, output, _ = run("check", campaign)
    assert (code, output) == (
        0,
        f"{campaign}: a campaign of 2 records, 1 channel and 1 force channel,"
        " up to 64 s at 256 Hz\n",
    )


def test_a_file_for_an_identified_structure_is_described(run, tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("structure: {kind: identified, band_Hz: [5, 60]}\n")
    assert run("check", path)[1] == (
        f"{path}: a structure to be identified from its campaign, 5 to 60 Hz\n"
    )
    path.write_text("structure: {kind: identified, bnd_Hz: [5, 60]}\n")
    code, _, errors = run("check", path)
    assert code == 1 and "did you mean 'band_Hz'?" in errors


def test_schema_and_reference_are_printed(run):
    assert json.loads(run("schema")[1])["title"] == "vibroimpact study"
    assert run("reference")[1].startswith("# Configuration keys")


def test_help_and_version_answer_without_numpy():
    code = (
        "import sys, vibroimpact.cli as cli\n"
        "try:\n    cli.main(['--help'])\nexcept SystemExit: pass\n"
        "assert not {'numpy', 'pydantic', 'yaml'} & set(sys.modules)"
    )
    shown = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT / "src"
    )
    assert shown.returncode == 0, shown.stderr
    for command in ("check", "schema", "reference"):
        assert command in shown.stdout
    version = subprocess.run(
        [sys.executable, "-m", "vibroimpact", "--version"],
        capture_output=True,
        text=True,
        cwd=ROOT / "src",
    )
    assert version.stdout == f"vibroimpact {vibroimpact.__version__}\n"


@pytest.mark.parametrize("command", [["check"], ["new"], ["equivalent", "--load=1", "--gap=1e-4"]])
def test_a_path_that_is_too_long_is_refused(command, capsys):
    assert main([*command, "a" * 5000]) == 1
    assert "a" * 5000 in capsys.readouterr().err
