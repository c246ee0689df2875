"""The scripts of the study, run in this process: a warning in any of them is an error here, and
every file says what it holds and where it comes from.
"""

import netCDF4
import numpy as np
import pytest
import yaml

import vibroimpact
from tests.support.tiny_study import SOURCE_DIGEST, TinyStudy, tiny_values
from vibroimpact.config.stage_keys import stage_params
from vibroimpact.io.provenance import config_digest

STAGES = {
    "model": "basis",
    "records": "simulate",
    "timeseries": "simulate",
    "spectra": "spectra",
    "estimates": "identify",
    "consistency": "consistency",
    "synthetic_campaign": "synthetic_campaign",
}


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A tiny study up to its tables. Any warning fails here: pytest makes errors of them."""
    study = TinyStudy(tmp_path_factory.mktemp("tiny"), tiny_values())
    study.simulate()
    study.identify()
    return study


def file_of(study, kind):
    """One of the files of a kind."""
    names = ("records", "timeseries", "spectra", "estimates")
    return study.files(kind)[0] if kind in names else study.path(f"{kind}.nc")


def test_no_script_of_the_study_warns(study):
    logs = list((study.folder / "logs").glob("*.log"))
    assert len(logs) == 9
    assert [log.name for log in logs if "Warning" in log.read_text()] == []


def test_the_script_runner_sees_a_warning(study, monkeypatch):
    def warning(*arguments):
        return np.float64(1.0) / np.float64(0.0)

    monkeypatch.setattr("vibroimpact.stages.statistics.statistics_rows", warning)
    with pytest.raises(RuntimeWarning, match="divide by zero"):
        study.run("statistics", {"records": study.files("records")}, {"table": "none"})


@pytest.mark.slow
def test_no_figure_of_the_study_warns(study):
    study.draw()
    assert len(list((study.folder / "figures").glob("*.png"))) == 19


@pytest.mark.parametrize("kind", STAGES)
def test_every_file_states_its_origin_and_configuration(study, kind):
    with netCDF4.Dataset(file_of(study, kind)) as file:
        given = {name: file.getncattr(name) for name in file.ncattrs()}
    keys = stage_params(study.config, STAGES[kind])
    assert given["vibroimpact_version"] == vibroimpact.__version__
    assert given["config_digest"] == config_digest(keys)
    assert given["source_digest"] == SOURCE_DIGEST
    assert config_digest(yaml.safe_load(given["configuration"])) == given["config_digest"]
    if kind != "model":
        assert given["study"] == "tiny"
    if kind in ("records", "timeseries", "spectra", "estimates"):
        assert given["seed"] == 0 and given["case"].startswith("load_4_gap_0.0001")


@pytest.mark.parametrize("kind", STAGES)
def test_every_variable_says_what_it_is_and_in_what_unit(study, kind):
    silent = []
    with netCDF4.Dataset(file_of(study, kind)) as file:
        for name, variable in file.variables.items():
            given = set(variable.ncattrs())
            numbers = variable.dtype is not str
            if "long_name" not in given:
                silent.append(f"{name}: no long_name")
            if numbers and not given & {"units", "comment"} and name not in ("seed", "response"):
                silent.append(f"{name}: no unit")
            # UDUNITS has no fractional powers: it would read Hz-1/2 as half of Hz-1.
            if "/" in getattr(variable, "units", ""):
                silent.append(f"{name}: {variable.units}")
    assert silent == []


def test_files_of_two_runs_have_the_same_bits_but_for_history(study, tmp_path):
    again = TinyStudy(tmp_path, tiny_values())
    again.simulate()
    for kind in ("model", "records", "timeseries", "spectra"):
        with (
            netCDF4.Dataset(file_of(study, kind)) as one,
            netCDF4.Dataset(file_of(again, kind)) as other,
        ):
            differing = {
                name for name in one.ncattrs() if one.getncattr(name) != other.getncattr(name)
            }
            assert differing <= {"history"} and one.ncattrs() == other.ncattrs()
            for name, variable in one.variables.items():
                same = other.variables[name]
                assert np.asarray(variable[...]).tobytes() == np.asarray(same[...]).tobytes() or (
                    variable.dtype is str and list(variable[:]) == list(same[:])
                )
                assert variable.__dict__ == same.__dict__
