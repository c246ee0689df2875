"""Every kind of netCDF file of a study keeps the CF conventions, says the checker of IOOS."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr

from tests.support.tiny_study import TinyStudy, tiny_values
from vibroimpact.io.records import write_record

CONVENTIONS = "cf:1.11"
# In a campaign file `time` is the name that its contract gives to the time of a record, in seconds
# from its start. The checker takes any dimension of that name for a date, which CF does not.
NO_DATE = "Coordinate variable 'time' should have standard_name='time', found: 'None'"


@pytest.fixture(scope="module")
def checker():
    """The compliance checker beside this interpreter, or on the path."""
    folders = [str(Path(sys.executable).parent), None]
    found = [shutil.which("compliance-checker", path=folder) for folder in folders]
    if not any(found):
        pytest.skip("compliance-checker is not installed: `make judges` has an environment with it")
    return next(filter(None, found))


@pytest.fixture(scope="module")
def findings(checker, tmp_path_factory):
    """{kind of file: what the checker finds in one of them}."""
    folder = tmp_path_factory.mktemp("cf")
    study = TinyStudy(folder / "study", tiny_values())
    study.simulate()
    study.identify()
    values = tiny_values()
    values["record"] |= {"every_step": True, "duration_s": 0.01}
    values["integration"]["start_up_s"] = 0.0
    short = TinyStudy(folder / "every_step", values | {"identification": None})
    short.simulate()
    kinds = ("records", "timeseries", "spectra", "estimates")
    files = {kind: study.files(kind)[0] for kind in kinds}
    files |= {name: study.path(f"{name}.nc") for name in ("model", "consistency")}
    files |= {"campaign": study.path("synthetic_campaign.nc")}
    files |= {"every step": short.files("timeseries")[0], "run energies": short.files("records")[0]}
    return {kind: found_in(checker, file, folder) for kind, file in files.items()}


def found_in(checker, file, folder):
    """The sentences of the checker on a file, and what went wrong in the checker itself."""
    report = folder / "report.json"
    command = [checker, "-t", CONVENTIONS, "-f", "json", "-o", str(report), str(file)]
    run = subprocess.run(command, capture_output=True, text=True)
    text = run.stdout + run.stderr
    assert report.is_file(), text
    told = json.loads(report.read_text())[CONVENTIONS]
    report.unlink()
    sections = ("high_priorities", "medium_priorities", "low_priorities")
    messages = {
        message for section in sections for check in told[section] for message in check["msgs"]
    }
    errors = {line for line in text.splitlines() if line.startswith(CONVENTIONS)}
    return messages | errors


@pytest.mark.parametrize(
    "kind",
    [
        "model",
        "records",
        "timeseries",
        "spectra",
        "estimates",
        "consistency",
        "every step",
        "run energies",
    ],
)
def test_files_of_a_study_keep_the_cf_conventions(findings, kind):
    assert findings[kind] == set()


def test_campaign_keeps_cf_but_for_the_name_of_its_time(findings):
    assert findings["campaign"] == {NO_DATE}


def test_checker_finds_a_unit_that_is_none(checker, tmp_path):
    wrong = xr.Dataset({"k": ("x", [1.0], {"units": "newtons of force", "long_name": "k"})})
    write_record(wrong, tmp_path / "wrong.nc")
    assert any("units" in message for message in found_in(checker, tmp_path / "wrong.nc", tmp_path))
