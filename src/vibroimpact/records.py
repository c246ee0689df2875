"""Reading and writing of netCDF files and tables. No other module opens them."""

import csv
import os
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

# The end of a label's name in a file. By the CF conventions (1.11, sections 5 and 6.1) only numbers
# may carry the name of their dimension, so the names of supports are support_name (support).
LABEL = "_name"
# Seconds from the start of a record are no date, which is what a dimension `time` stands for
# (CF 4.4).
TIME, TIME_IN_FILE = "time", "elapsed_time"
# Measured values are compressed ten times at most; a file that holds less was never filled.
MOST_TIMES_SMALLER, SMALL_BYTES = 100, 10**8


class RecordError(Exception):
    """A file that cannot be read or written; the message names it."""


def write_record(dataset: xr.Dataset, path: str | Path, names_kept: bool = False) -> None:
    """Write a dataset of numbers and texts as netCDF-4.

    names_kept: as in RecordFile.

    The file appears complete or not at all. Raises TypeError for other contents.
    """
    with RecordFile(path, dataset, names_kept=names_kept):
        pass


class RecordFile:
    """A netCDF-4 file that is written piece by piece inside a `with` block.

    It has a temporary name in the same folder until the end of the block, and is then renamed. If
    the block raises, no file remains. Time series of float32 are not compressed: their noise does
    not shrink, and compression takes longer than the simulation. `Dataset.to_netcdf` is not used
    because it takes twice as long for files of many small variables.
    """

    def __init__(
        self,
        path: str | Path,
        dataset: xr.Dataset,
        parts: dict[str, tuple] | None = None,
        sizes: dict[str, int] | None = None,
        names_kept: bool = False,
    ) -> None:
        """Create the file and write what is known from the start.

        dataset: variables of numbers and texts, written at once.
        parts: {name: (dimensions, type, attributes)} of the variables that `put` fills later.
        sizes: {dimension: length} of dimensions that only the parts have.
        names_kept: write all names as they are. Otherwise labels of a dimension and the time get
            the names that CF asks for, support_name and elapsed_time, which read_record undoes.

        Raises TypeError for a variable that holds neither numbers nor texts.
        """
        self._names = {} if names_kept else _names_in_file(dataset)
        self._path = Path(path)
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._temporary = self._path.with_name(f".{self._path.name}.{os.getpid()}")
        self._file = netCDF4.Dataset(self._temporary, "w", format="NETCDF4")
        try:
            self._file.set_fill_off()
            lengths: dict = {**dataset.sizes, **(sizes or {})}
            for name, size in lengths.items():
                self._file.createDimension(_dimension(str(name), self._names), size)
            unnamed = _put_variables(self._file, dataset, parts or {}, self._names)
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

    def put(self, name: str, place: Any, values: np.ndarray) -> None:
        """Write values into a part, at an index or slices."""
        self._file[name][place] = values

    def __enter__(self) -> "RecordFile":
        return self

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        self._close(keep=kind is None)

    def _close(self, keep: bool) -> None:
        try:
            self._file.close()
            if keep:
                os.replace(self._temporary, self._path)
        finally:
            self._temporary.unlink(missing_ok=True)


def _names_in_file(dataset: xr.Dataset) -> dict[str, str]:
    """Return {name of a variable: its name in the file} of those that CF wants called otherwise."""
    labels = [str(name) for name in dataset.coords if name in dataset.sizes]
    names = {name: name + LABEL for name in labels if dataset[name].dtype.kind in "UO"}
    taken = set(names.values()) & {str(name) for name in dataset.variables}
    if taken:
        raise TypeError(f"{sorted(taken)}: this is the name of labels in the file, take another")
    return names | ({TIME: TIME_IN_FILE} if TIME in dataset.sizes else {})


def _dimension(name: str, names: dict[str, str]) -> str:
    """Return the name of a dimension in the file: that of a label's dimension stays."""
    return TIME_IN_FILE if name == TIME and TIME in names else name


def _put_variables(
    file: netCDF4.Dataset, dataset: xr.Dataset, parts: dict, names: dict[str, str]
) -> list:
    """Create all variables and write those of the dataset.

    names: {name of a variable: its name in the file} where they differ.

    Returns the auxiliary coordinates that no variable refers to. An auxiliary coordinate is one
    whose name is not that of a dimension.
    """
    auxiliary = {
        names.get(str(name), name): set(dataset[name].dims)
        for name in dataset.coords
        if name not in dataset.sizes or (name in names and name != TIME)
    }
    named: set[str] = set()
    for name, variable in dataset.variables.items():
        values = variable.values
        text = values.dtype.kind in "UO" and all(isinstance(value, str) for value in values.flat)
        if not text and values.dtype.kind not in "fiu":
            raise TypeError(f"'{name}' holds {values.dtype}: numbers and texts alone are written")
        attributes = dict(variable.attrs)
        if name not in dataset.coords:
            attributes |= _coordinates_attribute(variable.dims, auxiliary, named)
        dims = [_dimension(str(dim), names) for dim in variable.dims]
        kind = str if text else values.dtype
        stored = _create(file, names.get(str(name), name), kind, dims, attributes)
        if values.size:
            stored[...] = values.astype(object) if text else values
    for name, (dims, dtype, attributes) in parts.items():
        coordinates = _coordinates_attribute(dims, auxiliary, named)
        dims = [_dimension(str(dim), names) for dim in dims]
        _create(file, name, dtype, dims, attributes | coordinates)
    return [name for name in auxiliary if name not in named]


def _create(file, name, dtype, dims, attributes):
    stored = file.createVariable(name, dtype, dims)
    stored.setncatts(attributes)
    stored.set_auto_maskandscale(False)
    return stored


def _coordinates_attribute(dims: Iterable, auxiliary: dict, named: set) -> dict[str, str]:
    """Return the CF attribute `coordinates` of a variable, and add its entries to `named`."""
    mine = [name for name, needed in auxiliary.items() if needed <= set(dims)]
    named.update(mine)
    return {"coordinates": " ".join(mine)} if mine else {}


def read_record(path: str | Path, names: Iterable[str] | None = None) -> xr.Dataset:
    """Return the dataset of a file of write_record, loaded into memory.

    names: the variables wanted; all of them by default.

    Raises RecordError when there is no such file or it is not netCDF, KeyError when a variable is
    missing.
    """
    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_maskandscale(False)
            auxiliary = set(getattr(file, "coordinates", "").split())
            data = {}
            for name in file.variables if names is None else names:
                data[name], others = _variable(file.variables[name])
                auxiliary.update(others)
            if names is not None:
                coordinates = {
                    *auxiliary,
                    *(dim for variable in data.values() for dim in variable.dims),
                } & set(file.variables)
                data.update(
                    {name: _variable(file.variables[name])[0] for name in coordinates - set(data)}
                )
            attributes = {
                name: file.getncattr(name) for name in file.ncattrs() if name != "coordinates"
            }
            labels = {name for name in auxiliary if _labels_of(file, name)}
    except OSError as error:
        raise RecordError(
            f"{path}: cannot be read as netCDF ({error}): delete it and run again"
        ) from error
    return _with_own_names(data, auxiliary, labels, attributes)


def _labels_of(file: netCDF4.Dataset, name: str) -> bool:
    """Return whether an auxiliary coordinate holds the labels of its dimension, by its name."""
    variable = file.variables.get(name)
    return (
        variable is not None
        and variable.dtype is str
        and variable.dimensions == (name.removesuffix(LABEL),)
        and name.endswith(LABEL)
    )


def _with_own_names(data: dict, auxiliary: set, labels: set, attributes: dict) -> xr.Dataset:
    """Return the Dataset of a file's variables, labels and time under the names they had."""
    names = {name: name.removesuffix(LABEL) for name in labels} | {TIME_IN_FILE: TIME}
    for name, variable in list(data.items()):
        dims = [TIME if dim == TIME_IN_FILE else dim for dim in variable.dims]
        if tuple(dims) != variable.dims:
            variable = xr.Variable(dims, variable.values, variable.attrs, fastpath=True)
        del data[name]
        data[names.get(name, name)] = variable
    sizes = {dim for variable in data.values() for dim in variable.dims}
    coords = {name: data.pop(name) for name in list(data) if name in auxiliary | sizes}
    return xr.Dataset(data, coords, attributes)


def _variable(stored: netCDF4.Variable) -> tuple[xr.Variable, list[str]]:
    """Return a netCDF variable and the names of its auxiliary coordinates."""
    attributes = {name: stored.getncattr(name) for name in stored.ncattrs()}
    auxiliary = attributes.pop("coordinates", "").split()
    return xr.Variable(stored.dimensions, stored[...], attributes, fastpath=True), auxiliary


def read_attributes(path: str | Path) -> dict[str, Any]:
    """Return the global attributes of a netCDF file. Raises RecordError."""
    try:
        with netCDF4.Dataset(path) as file:
            return {name: file.getncattr(name) for name in file.ncattrs()}
    except OSError as error:
        raise RecordError(
            f"{path}: cannot be read as netCDF ({error}): delete it and run again"
        ) from error


def read_dataset(path: str | Path) -> xr.Dataset:
    """Return the dataset of any netCDF file, decoded by the CF conventions; the time of a record is
    called `time`, as in read_record. Raises RecordError.
    """
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            own = {} if TIME in dataset.sizes else {TIME_IN_FILE: TIME}
            names = {name: own[name] for name in (*dataset.variables, *dataset.dims) if name in own}
            return dataset.load().rename(names)
    except OSError as error:
        raise RecordError(
            f"{path}: cannot be read as netCDF ({error}): delete it and run again"
        ) from error


def read_given_dataset(path: str | Path, described: Iterable[str] = ()) -> xr.Dataset:
    """Return the dataset of a netCDF file that a user gives, in any state.

    described: variables whose values are not read: zeros of their shape and type stand for them.

    Texts are decoded and packed numbers unpacked; no variable is taken for a date. The time of a
    record is called `time`, as in read_record. Raises RecordError for whatever can not be read.
    """
    place = Path(path)
    if not place.is_file():
        raise RecordError(f"{path}: is no file: give the path of a netCDF file")
    try:
        with xr.open_dataset(
            path, engine="netcdf4", decode_times=False, decode_timedelta=False
        ) as dataset:
            _require_plausible_size(dataset, place)
            shown = {name: dataset[name] for name in described if name in dataset.variables}
            values = dataset.drop_vars(list(shown)).load()
            for name, variable in shown.items():
                zeros = np.broadcast_to(np.zeros((), variable.dtype), variable.shape)
                values[name] = (variable.dims, zeros, variable.attrs)
            own = {} if TIME in values.sizes else {TIME_IN_FILE: TIME}
            names = {name: own[name] for name in (*values.variables, *values.dims) if name in own}
            return values.rename(names)
    except RecordError:
        raise
    except Exception as error:  # of a damaged file, netCDF4 and xarray raise nearly anything
        told = str(getattr(error, "strerror", None) or error).strip()
        why = (told.splitlines() or [type(error).__name__])[0]
        raise RecordError(
            f"{path}: can not be read as netCDF ({why}): it is no netCDF file, or damaged: copy it"
            " or make it again"
        ) from error


def _require_plausible_size(dataset: xr.Dataset, path: Path) -> None:
    """Raise RecordError where the variables of a file are far larger than the file.

    They would fill the memory with values that were never written.
    """
    stored = path.stat().st_size
    if dataset.nbytes > max(SMALL_BYTES, MOST_TIMES_SMALLER * stored):
        largest = max(dataset.variables, key=lambda name: dataset[name].nbytes)
        raise RecordError(
            f"{path}: claims {dataset.nbytes / 1e9:.3g} GB of values, most of them in '{largest}'"
            f" {tuple(dataset[largest].shape)}, but has {stored} bytes: it was cut off or never"
            " filled: make it again"
        )


def read_numeric_variables(path: str | Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Return (numeric variables by name, global attributes) of any netCDF file.

    Masked values become NaN. Raises RecordError.
    """
    try:
        with netCDF4.Dataset(path) as file:
            values = {
                name: np.ma.filled(variable[:], np.nan)
                for name, variable in file.variables.items()
                if variable.dtype != str and variable.dtype.kind in "fiu"
            }
            return values, {name: file.getncattr(name) for name in file.ncattrs()}
    except OSError as error:
        raise RecordError(f"{path}: cannot be read as netCDF ({error})") from error


def read_hdf5_arrays(path: str | Path) -> dict[str, np.ndarray]:
    """Return the numeric arrays of an HDF5 file as MATLAB v7.3 writes it.

    Keys are group.name; axes are in MATLAB's order. Raises RecordError.
    """
    # Imported here: it brings an HDF5 library of its own, which other stages do not need.
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
        raise RecordError(f"{path}: cannot be read as HDF5 ({error})") from error
    return found


def write_table(rows: list[dict], path: str | Path, columns: tuple[str, ...] = ()) -> None:
    """Write rows with the same keys as CSV, whole or not at all.

    Floats are written in full precision, NaN as 'nan'.

    columns: the header of a table that may have no rows.
    """
    columns = tuple(rows[0]) if rows else tuple(columns)
    write_cells(columns, ([_plain(row[column]) for column in columns] for row in rows), path)


def write_cells(columns: Iterable[str], rows: Iterable, path: str | Path) -> None:
    """Write rows of plain Python values under a header as CSV, whole or not at all."""
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


def write_text(text: str, path: str | Path) -> None:
    """Write a text file, whole or not at all."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


def read_text(path: str | Path) -> str:
    """Return the text of a file. Raises RecordError when there is no such file."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise RecordError(f"{path}: cannot be read ({error.strerror})") from error


def read_table(path: str | Path) -> list[dict[str, Any]]:
    """Return the rows of a CSV table; what reads as a number becomes one.

    Raises RecordError when there is no such file.
    """
    try:
        with open(path, newline="", encoding="utf-8") as file:
            return [
                {key: _number(value) for key, value in row.items()} for row in csv.DictReader(file)
            ]
    except OSError as error:
        raise RecordError(f"{path}: cannot be read ({error.strerror})") from error


def _plain(value):
    # csv writes a float in full, but a float32 in its own few digits.
    return float(value) if isinstance(value, np.floating) else value


def _number(text):
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def plain_values(value: Any) -> Any:
    """Return nested values as JSON and YAML know them.

    numpy types become Python's; a float that is not finite becomes None.
    """
    if isinstance(value, dict):
        return {str(key): plain_values(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain_values(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain_values(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not np.isfinite(value) else value
