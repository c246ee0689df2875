"""Files come back as they were written, and a failed write leaves nothing behind."""

import netCDF4
import numpy as np
import pytest
import xarray as xr

from vibroimpact.io import records
from vibroimpact.reduction import model_file
from vibroimpact.study import record_variables as variables


def test_the_model_comes_back_bit_for_bit(study_model, tmp_path):
    model_file.write_model(study_model, tmp_path / "model.nc")
    again = model_file.read_model(tmp_path / "model.nc")
    for name in study_model.__dataclass_fields__:
        came, given = getattr(again, name), getattr(study_model, name)
        columns = vars(given) if name in model_file.LAWS else {}
        assert all(
            np.array_equal(getattr(came, column), value, equal_nan=True)
            for column, value in columns.items()
        ), name
        assert columns or np.array_equal(came, given), name


def test_record_has_units_and_splits_in_two_files(tmp_path):
    values = {"displacement": np.ones((2, 5)), "impact_count": [3], "energy_residual": 1e-12}
    coordinates = {"sensor": ["apex.x", "apex.y"], "time": np.arange(5.0), "support": ["left"]}
    record = variables.describe(values, coordinates, {"case": "one"})
    statistics, series = variables.split_record(record)
    assert set(series.data_vars) == {"displacement"}
    assert set(statistics.data_vars) == {"impact_count", "energy_residual"}
    assert "time" not in statistics.sizes
    records.write_record(series, tmp_path / "series.nc")
    again = records.read_record(tmp_path / "series.nc")
    assert again["displacement"].attrs["units"] == "m"
    assert again["displacement"].dtype == np.float32
    assert again.attrs["case"] == "one"
    assert again.attrs["Conventions"].startswith("CF-")


def test_file_written_in_pieces_equals_the_whole(tmp_path):
    values = np.arange(12.0, dtype="f4").reshape(2, 6)
    coordinates = {"time": ("time", np.arange(6.0)), "place": ("point", [0.5, 1.5], {"units": "m"})}
    whole = xr.Dataset(
        {"series": (("point", "time"), values, {"units": "m"}), "name": ("point", ["a", "b"])},
        coordinates,
        {"case": "one"},
    )
    parts = {"series": (("point", "time"), "f4", {"units": "m"})}
    with records.record_file(tmp_path / "pieces.nc", whole.drop_vars("series"), parts) as put:
        for place in (slice(0, 4), slice(4, 6)):
            put("series", np.s_[:, place], values[:, place])
        assert not (tmp_path / "pieces.nc").exists()
    again = records.read_record(tmp_path / "pieces.nc")
    assert again.equals(whole) and again.attrs["case"] == "one"
    assert again["place"].attrs == {"units": "m"}


def test_labels_and_time_have_the_names_that_cf_asks_for(tmp_path):
    dataset = xr.Dataset(
        {
            "force": (("support", "time"), np.arange(6.0).reshape(2, 3)),
            "k": ("support", [1.0, 2.0]),
        },
        {"support": ["left", "right"], "time": [0.0, 0.5, 1.0]},
    )
    records.write_record(dataset, tmp_path / "cf.nc")
    with netCDF4.Dataset(tmp_path / "cf.nc") as stored:
        assert stored["force"].dimensions == ("support", "elapsed_time")
        assert stored["force"].coordinates == "support_name"
        assert set(stored.variables) == {"force", "k", "elapsed_time", "support_name"}
        assert list(stored["support_name"][:]) == ["left", "right"]
    assert records.read_given_dataset(tmp_path / "cf.nc")["force"].dims == ("support", "time")
    for names, expected in ((None, dataset), (["k"], dataset[["k"]])):
        again = records.read_record(tmp_path / "cf.nc", names)
        assert again.equals(expected)
    assert float(again["k"].sel(support="right")) == 2.0
    records.write_record(dataset, tmp_path / "kept.nc", names_kept=True)
    assert records.read_given_dataset(tmp_path / "kept.nc").equals(dataset)


def test_a_variable_with_the_name_of_labels_is_refused(tmp_path):
    dataset = xr.Dataset({"x_name": ("x", [1.0])}, {"x": ["a"]})
    with pytest.raises(TypeError, match="x_name.*take another"):
        records.write_record(dataset, tmp_path / "twice.nc")
    assert list(tmp_path.iterdir()) == []


def test_some_variables_of_a_file_come_with_their_coordinates(tmp_path):
    dataset = xr.Dataset(
        {"a": ("x", [1.0, 2.0]), "b": ("y", [3.0]), "c": ((), 4)},
        {"x": [5, 6], "y": ["seven"], "beside": ("x", [8.0, 9.0])},
    )
    records.write_record(dataset, tmp_path / "some.nc")
    some = records.read_record(tmp_path / "some.nc", ["a", "c"])
    assert some.equals(dataset[["a", "c"]]) and set(some.coords) == {"x", "beside"}
    assert records.read_record(tmp_path / "some.nc").equals(dataset)
    with pytest.raises(records.RecordError, match="some.nc: has no variable 'none'.*run again"):
        records.read_record(tmp_path / "some.nc", ["none"])


def test_unfinished_file_is_removed(tmp_path):
    with pytest.raises(RuntimeError, match="stopped"):
        with records.record_file(tmp_path / "half.nc", xr.Dataset({"a": 1.0})):
            raise RuntimeError("stopped")
    assert list(tmp_path.iterdir()) == []


def test_an_undeclared_variable_is_refused():
    with pytest.raises(KeyError, match="nonsense"):
        variables.describe({"nonsense": 1.0}, {}, {})


def test_a_failed_write_leaves_no_file(tmp_path):
    dataset = xr.Dataset({"bad": ("x", np.array([object()], dtype=object))})
    with pytest.raises((ValueError, TypeError)):
        records.write_record(dataset, tmp_path / "bad.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_broken_file_is_named(tmp_path):
    (tmp_path / "broken.nc").write_bytes(b"not netCDF")
    with pytest.raises(records.RecordError, match="broken.nc: cannot be read as netCDF"):
        records.read_record(tmp_path / "broken.nc")


def test_attributes_are_read_without_the_data(tmp_path):
    written = xr.Dataset({"value": ("x", np.zeros(3))}, attrs={"source_digest": "0a1b", "seed": 4})
    records.write_record(written, tmp_path / "file.nc")
    found = records.read_attributes(tmp_path / "file.nc")
    assert (found["source_digest"], found["seed"]) == ("0a1b", 4)
    with pytest.raises(records.RecordError, match="absent.nc: cannot be read"):
        records.read_attributes(tmp_path / "absent.nc")


def test_an_empty_table_keeps_its_header(tmp_path):
    records.write_table([], tmp_path / "table.csv", ("a", "b"))
    assert (tmp_path / "table.csv").read_text().strip() == "a,b"


def test_tables_keep_numbers_and_nan(tmp_path):
    rows = [{"name": "a", "k": 0.1 + 0.2, "n": 3}, {"name": "b", "k": float("nan"), "n": 4}]
    records.write_table(rows, tmp_path / "table.csv")
    again = records.read_table(tmp_path / "table.csv")
    assert again[0] == rows[0]
    assert np.isnan(again[1]["k"])
