"""All netCDF and table reading and writing: one place, one declaration of every variable of a
record.
"""

import csv
import os
from datetime import UTC, datetime
from pathlib import Path

import netCDF4
import numpy as np
import xarray as xr


class RecordError(Exception):
    """A file that can not be read or written; the message names it."""


def write_record(dataset: xr.Dataset, path) -> None:
    """Write a dataset of numbers and texts as netCDF-4, whole or not at all. Raises TypeError for
    other contents.
    """
    with RecordFile(path, dataset):
        pass


class RecordFile:
    """A netCDF-4 file, filled piece by piece: under a temporary name in the same folder until the
    end of `with`, then renamed.

    dataset: what is known from the start (numbers and texts, else TypeError); parts {name:
    (dimensions, type, attributes)}: what comes later through `put`, of dimensions with sizes
    {dimension: length}. Left with an error no file remains. float32 time series are stored as they
    are: their noise does not compress, and deflating it costs more than the simulation. Written
    without Dataset.to_netcdf, which takes twice as long for files of many small variables.
    """

    def __init__(self, path, dataset: xr.Dataset, parts=None, sizes=None):
        self._path = Path(path)
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._temporary = self._path.with_name(f".{self._path.name}.{os.getpid()}")
        self._file = netCDF4.Dataset(self._temporary, "w", format="NETCDF4")
        try:
            self._file.set_fill_off()
            for name, size in (dict(dataset.sizes) | (sizes or {})).items():
                self._file.createDimension(name, size)
            unnamed = _put_variables(self._file, dataset, parts or {})
            self._file.setncatts(
                {
                    "title": "vibroimpact record",
                    **dataset.attrs,
                    "Conventions": "CF-1.11",
                    "history": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} written by vibroimpact",
                    **({"coordinates": " ".join(unnamed)} if unnamed else {}),
                }
            )
        except BaseException:
            self._close(keep=False)
            raise

    def put(self, name, place, values) -> None:
        """Write values of a part at a place (index or slices)."""
        self._file[name][place] = values

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        self._close(keep=kind is None)

    def _close(self, keep):
        try:
            self._file.close()
            if keep:
                os.replace(self._temporary, self._path)
        finally:
            self._temporary.unlink(missing_ok=True)


def _put_variables(file, dataset, parts) -> list[str]:
    """Create all variables and write those of the dataset; return the coordinates off the
    dimensions that no variable names.
    """
    beside = {name: set(dataset[name].dims) for name in dataset.coords if name not in dataset.sizes}
    named = set()
    for name, variable in dataset.variables.items():
        values = variable.values
        text = values.dtype.kind in "UO" and all(isinstance(value, str) for value in values.flat)
        if not text and values.dtype.kind not in "fiu":
            raise TypeError(f"'{name}' holds {values.dtype}: numbers and texts alone are written")
        mine = (
            {} if name in dataset.coords else _coordinates_attribute(variable.dims, beside, named)
        )
        stored = _create(
            file, name, str if text else values.dtype, variable.dims, variable.attrs | mine
        )
        if values.size:
            stored[...] = values.astype(object) if text else values
    for name, (dims, dtype, attributes) in parts.items():
        _create(file, name, dtype, dims, attributes | _coordinates_attribute(dims, beside, named))
    return [name for name in beside if name not in named]


def _create(file, name, dtype, dims, attributes):
    stored = file.createVariable(name, dtype, dims)
    stored.setncatts(attributes)
    stored.set_auto_maskandscale(False)
    return stored


def _coordinates_attribute(dims, beside, named):
    """The attribute that names a variable's coordinates off its dimensions, by the CF conventions;
    they are added to the set `named`.
    """
    mine = [name for name, needed in beside.items() if needed <= set(dims)]
    named.update(mine)
    return {"coordinates": " ".join(mine)} if mine else {}


def read_record(path, names=None) -> xr.Dataset:
    """The dataset of a file of write_record, loaded, file closed; names: the variables wanted, all
    where left out.

    Raises RecordError when there is no such file or it is not netCDF, KeyError when a variable is
    missing.
    """
    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_maskandscale(False)
            beside = set(getattr(file, "coordinates", "").split())
            data = {}
            for name in file.variables if names is None else names:
                data[name], others = _variable(file.variables[name])
                beside.update(others)
            if names is not None:
                coordinates = {
                    *beside,
                    *(dim for variable in data.values() for dim in variable.dims),
                } & set(file.variables)
                data.update(
                    {name: _variable(file.variables[name])[0] for name in coordinates - set(data)}
                )
            attributes = {
                name: file.getncattr(name) for name in file.ncattrs() if name != "coordinates"
            }
    except OSError as error:
        raise RecordError(
            f"{path}: can not be read as netCDF ({error}): delete it and run again"
        ) from error
    sizes = {dim for variable in data.values() for dim in variable.dims}
    coords = {name: data.pop(name) for name in list(data) if name in beside | sizes}
    return xr.Dataset(data, coords, attributes)


def _variable(stored):
    """(variable, names of its coordinates off the dimensions) of a netCDF variable."""
    attributes = {name: stored.getncattr(name) for name in stored.ncattrs()}
    beside = attributes.pop("coordinates", "").split()
    return xr.Variable(stored.dimensions, stored[...], attributes, fastpath=True), beside


def read_dataset(path) -> xr.Dataset:
    """The dataset of a netCDF file of any origin, decoded by the CF conventions, loaded, file
    closed. Raises RecordError.
    """
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            return dataset.load()
    except OSError as error:
        raise RecordError(
            f"{path}: can not be read as netCDF ({error}): delete it and run again"
        ) from error


def read_variable(path) -> tuple[dict[str, np.ndarray], dict]:
    """Every numeric variable of a netCDF file by name, and its global attributes (for files of any
    origin).
    """
    try:
        with netCDF4.Dataset(path) as file:
            known = {
                name: np.ma.filled(variable[:], np.nan)
                for name, variable in file.variables.items()
                if variable.dtype != str and variable.dtype.kind in "fiu"
            }
            return known, {name: file.getncattr(name) for name in file.ncattrs()}
    except OSError as error:
        raise RecordError(f"{path}: can not be read as netCDF ({error})") from error


def read_hdf5_arrays(path) -> dict[str, np.ndarray]:
    """Every array of numbers of an HDF5 file as MATLAB v7.3 writes them: group.name, axes in
    MATLAB's order. Raises RecordError.
    """
    # imported here: its HDF5 library is another than netCDF4's, and other stages need only that one
    import h5py

    found = {}

    def collect(name, item):
        if (
            isinstance(item, h5py.Dataset)
            and item.dtype.kind in "fiu"
            and not name.startswith("#")
            and "MATLAB_empty" not in item.attrs
        ):
            found[name.replace("/", ".")] = item[()].T

    try:
        with h5py.File(path, "r") as file:
            file.visititems(collect)
    except OSError as error:
        raise RecordError(f"{path}: can not be read as HDF5 ({error})") from error
    return found


def write_table(rows: list[dict], path, columns: tuple[str, ...] = ()) -> None:
    """Write rows (all with the same keys) as CSV: floats in full precision, NaN as 'nan'. Atomic
    like write_record.

    columns: the header of a table that may have no rows.
    """
    columns = tuple(rows[0]) if rows else tuple(columns)
    write_cells(columns, ([_plain(row[column]) for column in columns] for row in rows), path)


def write_cells(columns, rows, path) -> None:
    """Write rows of plain Python values (columns,) under a header as CSV. Atomic like
    write_record.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with open(temporary, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(rows)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def write_text(text: str, path) -> None:
    """Write a text file, atomic like write_record."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


def read_text(path) -> str:
    """The text of a file. Raises RecordError when there is no such file."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise RecordError(f"{path}: can not be read ({error.strerror})") from error


def read_table(path) -> list[dict]:
    """Rows of a CSV table; what reads as a number is one. Raises RecordError when there is no such
    file.
    """
    try:
        with open(path, newline="", encoding="utf-8") as file:
            return [
                {key: _number(value) for key, value in row.items()} for row in csv.DictReader(file)
            ]
    except OSError as error:
        raise RecordError(f"{path}: can not be read ({error.strerror})") from error


def _plain(value):
    return (
        float(value) if isinstance(value, np.floating) else value
    )  # csv writes a float in full, a float32 in its own few digits


def _number(text):
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def plain(value):
    """Return nested values as JSON and YAML know them: without numpy types, None for what is not
    finite.
    """
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not np.isfinite(value) else value
