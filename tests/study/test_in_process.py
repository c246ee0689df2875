"""From a configuration to the equivalent support in one process, as in a notebook."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml

import vibroimpact
from tests.support.one_mass import one_mass
from vibroimpact.identify.estimate import METHODS, Estimate
from vibroimpact.study import in_process
from vibroimpact.study.support_estimates import SupportEstimates

ROOT = Path(__file__).parents[2]
# A mass of 1 kg on a spring of 40 Hz between two stops.
STIFFNESS = (2.0 * np.pi * 40.0) ** 2
CHAIN = one_mass(
    STIFFNESS,
    study="mine",
    damping={"kind": "modal", "other_ratio": 0.02},
    supports=[
        {
            "name": "stop",
            "point": "mass",
            "stiffness_N_per_m": 1.0e5,
            "profile": {"kind": "planes", "normals_deg": [0.0, 180.0]},
        }
    ],
    grid={"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
    record={"duration_s": 5.0, "sensors": {"points": ["mass"], "directions": ["x"]}},
)


@pytest.fixture(scope="module")
def chain():
    """The mass between stops; without identification."""
    return vibroimpact.check_config(CHAIN, "mine")


@pytest.fixture(scope="module")
def tube():
    """The small study with one case, which rattles."""
    config = vibroimpact.load_config(ROOT / "config" / "smoke.yaml")
    grid = {"grid.load_rms_N": [4.0], "grid.gap_m": [2.8886e-4], "grid.seeds": 1}
    return vibroimpact.changed_config(config, grid)


@pytest.fixture(scope="module")
def record(tube):
    """The record of the tube's case."""
    return vibroimpact.simulate_case(tube, load_rms_N=4.0, gap_m=2.8886e-4)


@pytest.fixture(scope="module")
def estimates(tube, record):
    """The equivalent support of the tube's case."""
    return vibroimpact.identify_support(tube, record)


def test_duration_and_seed_are_those_asked_for(chain):
    record = vibroimpact.simulate_case(chain, 1.0, 1.0e-3, seed=3, duration_s=2.0)
    assert record.sizes["time"] == 2.0 * chain.record.sampling_frequency_Hz
    assert record.attrs["seed"] == 3 and record.attrs["case"] == "load_1_gap_0.001_seed_3"


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"load_rms_N": -1.0}, r"grid\.load_rms_N\[0\] = -1\.0"),
        ({"gap_m": 0.0}, r"grid\.gap_m\[0\] = 0\.0"),
        ({"duration_s": 0.0}, r"record\.duration_s = 0\.0"),
    ],
)
def test_values_that_can_not_be_are_refused(chain, values, sentence):
    with pytest.raises(vibroimpact.ConfigError, match=sentence):
        vibroimpact.simulate_case(chain, **{"load_rms_N": 1.0, "gap_m": 1.0e-3, **values})


def test_every_method_has_an_estimate_with_its_units(estimates):
    assert list(estimates) == list(METHODS) and len(estimates) == len(METHODS)
    assert estimates.directions == [("all", "y")]
    table = estimates.to_dataset().isel(support_direction=0)
    assert table["k"].attrs["units"] == "N m-1" and table["c"].attrs["units"] == "N s m-1"
    assert float(table["k"].sel({"method": "ods"})) == estimates["ods"].k
    assert table.attrs == {"load_rms_N": 4.0, "gap_m": 2.8886e-4}
    with pytest.raises(KeyError, match="lsfc: the methods are peak_half, "):
        _ = estimates["lsfc"]


def test_several_supports_are_chosen_by_group_and_direction():
    places = [("plate_1", "y"), ("plate_2", "y")]
    found = SupportEstimates(
        4.0,
        1.0e-3,
        tuple(
            Estimate("ods", 1.0e5 * (1 + number), 1.0, group=group, direction=direction)
            for number, (group, direction) in enumerate(places)
        ),
        xr.Dataset(),
    )
    assert found.directions == places and found.of("plate_2", "y")["ods"].k == 2.0e5
    assert found.to_dataset()["k"].values.tolist() == [[1.0e5], [2.0e5]]
    with pytest.raises(KeyError, match=r'choose one by .of."plate_1", "y"'):
        _ = found["ods"]
    with pytest.raises(KeyError, match="identified are plate_1 in y, plate_2 in y"):
        found.of("plate_3", "y")


def test_estimates_are_shown_as_a_table_with_units(estimates):
    title, head, *lines = repr(estimates).splitlines()
    assert title == "Equivalent support at 4 N RMS, gap 0.2889 mm"
    assert "k N/m" in head and "c N s/m" in head
    shape = next(line for line in lines if line.startswith("ods")).split()
    assert shape[1:3] == [f"{estimates['ods'].k:.3g}", "±"] and shape[-2:] == ["-", "ok"]  # no c


def test_the_support_puts_the_pole_where_the_estimate_says(tube, estimates):
    # The pole behind an estimate is the first frequency of the linear tube on the stiffness found.
    model = vibroimpact.build_model(tube)
    out_of_plane = vibroimpact.natural_frequencies(model, estimates["lscf"].k, count=4)
    nearest = np.abs(out_of_plane / estimates["lscf"].frequency - 1.0).min()
    assert nearest < 0.005


def test_spectra_from_outside_give_the_same_support(tube, record, estimates):
    spectra = vibroimpact.case_spectra(tube, record)
    series = [name for name in record.data_vars if "time" in record[name].dims]
    again = vibroimpact.identify_support(tube, record.drop_vars(series), spectra)
    assert again.to_dataset().equals(estimates.to_dataset())
    assert again.curves.equals(estimates.curves)


def test_a_study_holds_the_estimates_of_its_cases(tube, estimates):
    study = vibroimpact.run_study(tube)
    k = study["k"].sel(load=4.0, gap=2.8886e-4, seed=0).values
    assert np.array_equal(k, estimates.to_dataset()["k"].values, equal_nan=True)
    assert np.array_equal(study["k_median"].values.ravel(), k.ravel(), equal_nan=True)


def test_without_identification_or_series_says_what_to_give(chain, tube, record):
    with pytest.raises(ValueError, match="'mine' has no section identification"):
        vibroimpact.identify_support(chain, record)
    with pytest.raises(ValueError, match="'mine' has no section identification"):
        vibroimpact.run_study(chain)
    with pytest.raises(ValueError, match="load_4_gap_0.00028886_seed_0 holds no time series"):
        vibroimpact.identify_support(tube, record[["force_displacement"]])


@pytest.mark.parametrize("name", vibroimpact.configurations())
def test_a_key_set_to_its_own_value_changes_nothing(name, monkeypatch):
    monkeypatch.chdir(ROOT)  # files that a configuration names are below its folder
    config = vibroimpact.load_config(vibroimpact.configurations()[name])
    assert vibroimpact.changed_config(config, {"seed": config.seed}) == config


def test_a_model_is_built_once_for_the_same_keys(tube):
    model = in_process.reduced_model(tube)
    louder = vibroimpact.changed_config(tube, {"grid.load_rms_N": [8.0]})
    lighter = vibroimpact.changed_config(tube, {"structure.material.density_kg_per_m3": 8000.0})
    assert in_process.reduced_model(louder) is model
    assert in_process.reduced_model(lighter) is not model


def test_a_path_stands_for_its_configuration(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(CHAIN))
    record = vibroimpact.simulate_case(path, load_rms_N=5.0, gap_m=1.0e-4)
    again = vibroimpact.simulate_case(str(path), load_rms_N=5.0, gap_m=1.0e-4)
    assert record.identical(again)


def test_spectra_say_what_they_want(chain, record, tube):
    with pytest.raises(vibroimpact.ConfigError, match="int is no configuration: give a Config"):
        vibroimpact.simulate_case(3, load_rms_N=5.0, gap_m=1.0e-4)
    with pytest.raises(vibroimpact.ConfigError, match="Dataset is no configuration"):
        vibroimpact.case_spectra(record, tube)
    with pytest.raises(ValueError, match="the record is of type Config: give that of simulate"):
        vibroimpact.case_spectra(tube, tube)
    with pytest.raises(ValueError, match="no time series of displacement: give that of"):
        vibroimpact.case_spectra(tube, record.drop_vars("displacement"))
