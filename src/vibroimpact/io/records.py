"""Reading and writing of netCDF files and tables. Only `hdf5` opens them too, to find damage."""

import csv
import io
import math
import os
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from .hdf5 import inspect_hdf5, is_hdf5
from .whole_file import MAKE_AGAIN, RecordError, read_text, whole_file

# The end of a label's name in a file. By the CF conventions (1.11, sections 5 and 6.1) only numbers
# may carry the name of their dimension, so the names of supports are support_name (support).
LABEL = "_name"
# Seconds from the start of a record are not a date, which is what a dimension `time` stands for (CF
# 4.4).
TIME, TIME_IN_FILE = "time", "elapsed_time"
# Limits of foreign files: a damaged one may claim any size, and memory is taken before it is read.
MOST_PACKED = 1100  # deflate makes zeros 1032 times smaller
MOST_READ, FLOAT_BYTES = 10**9, 8
# Measured values are compressed ten times at most; a file that holds less was never filled.
MOST_TIMES_SMALLER, SMALL_BYTES = 100, 10**8

FORMULA = re.compile(r"'*[=+\-@\t\r].")  # how a cell begins that a spreadsheet computes


def write_record(dataset: xr.Dataset, path: str | Path, names_kept: bool = False) -> None:
    """Write a dataset of numbers and texts as netCDF-4.

    names_kept: as in record_file.

    The file appears complete or not at all. Raises TypeError for other contents, RecordError if
    the folder cannot be written or is full.
    """
    with record_file(path, dataset, names_kept=names_kept):
        pass


@contextmanager
def record_file(
    path: str | Path,
    dataset: xr.Dataset,
    parts: dict[str, tuple] | None = None,
    sizes: dict[str, int] | None = None,
    names_kept: bool = False,
) -> Iterator[Callable[[str, Any, np.ndarray], None]]:
    """Create a netCDF-4 file that is written piece by piece inside a `with` block, which is given
    put(name of a part, index or slices, values).

    dataset: variables of numbers and texts, written at once.
    parts: {name: (dimensions, type, attributes)} of the variables that `put` fills later.
    sizes: {dimension: length} of dimensions that only the parts have.
    names_kept: write all names as they are. Otherwise labels of a dimension and the time get the
        names that CF asks for, support_name and elapsed_time, which read_record undoes.

    It has a temporary name in the same folder until the end of the block, and is then renamed. If
    the block raises, no file remains, see whole_file. Time series of float32 are not compressed:
    their noise does not shrink, and compression takes longer than the simulation.
    `Dataset.to_netcdf` is not used because it takes twice as long for files of many small
    variables. Raises TypeError for a variable that holds neither numbers nor texts, RecordError if
    the folder cannot be written or is full.
    """
    names = {} if names_kept else _names_in_file(dataset)
    with (
        whole_file(path) as temporary,
        closing(netCDF4.Dataset(temporary, "w", format="NETCDF4")) as file,
    ):
        file.set_fill_off()
        lengths: dict = {**dataset.sizes, **(sizes or {})}
        for name, size in lengths.items():
            file.createDimension(_dimension(str(name), names), size)
        unnamed = _put_variables(file, dataset, parts or {}, names)
        file.setncatts(
            {
                "title": "vibroimpact record",
                **dataset.attrs,
                "Conventions": "CF-1.11",
                "history": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} written by vibroimpact",
                **({"coordinates": " ".join(unnamed)} if unnamed else {}),
            }
        )

        def put(name: str, place: Any, values: np.ndarray) -> None:
            file[name][place] = values

        yield put


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

    names: {name of a variable: its name in the file} if they differ.

    Returns the auxiliary coordinates that no variable refers to.
    """
    auxiliary = {  # {name in the file: dimensions} of coordinates whose name is not a dimension's
        names.get(str(name), name): set(dataset[name].dims)
        for name in dataset.coords
        if name not in dataset.sizes or (name in names and name != TIME)
    }
    named: set[str] = set()
    for name, variable in dataset.variables.items():
        values = variable.values
        text = _is_text(str(name), values)
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


def _is_text(name: str, values: np.ndarray) -> bool:
    """Return whether values are texts. Raises TypeError if they are not numbers either."""
    text = values.dtype.kind in "UO" and all(isinstance(value, str) for value in values.flat)
    if not text and values.dtype.kind not in "fiu":
        raise TypeError(f"'{name}' holds {values.dtype}: numbers and texts alone are written")
    return text


def _coordinates_attribute(dims: Iterable, auxiliary: dict, named: set) -> dict[str, str]:
    """Return the CF attribute `coordinates` of a variable, and add its entries to `named`."""
    mine = [name for name, needed in auxiliary.items() if needed <= set(dims)]
    named.update(mine)
    return {"coordinates": " ".join(mine)} if mine else {}


def read_record(path: str | Path, names: Iterable[str] | None = None) -> xr.Dataset:
    """Return the dataset of a file of write_record, loaded into memory.

    names: the variables wanted; all of them by default.

    Raises RecordError when there is no such file, it is not netCDF, or lacks a variable.
    """
    with _opened(path) as file:
        file.set_auto_maskandscale(False)
        names = list(file.variables) if names is None else list(names)
        missing = [name for name in names if name not in file.variables]
        if missing:
            raise RecordError(
                f"{path}: has no variable '{missing[0]}': it is a file of another kind or version:"
                f" {MAKE_AGAIN}"
            )
        auxiliary = set(getattr(file, "coordinates", "").split())
        data = {}
        for name in names:
            data[name], others = _variable(file.variables[name])
            auxiliary.update(others)
        sizes = {str(dim) for variable in data.values() for dim in variable.dims}
        for coordinate in ((auxiliary | sizes) & set(file.variables)) - set(data):
            data[coordinate] = _variable(file.variables[coordinate])[0]
        attributes = {
            name: file.getncattr(name) for name in file.ncattrs() if name != "coordinates"
        }
        labels = {name for name in auxiliary if _labels_of(file, name)}
    return _with_own_names(data, auxiliary, labels, attributes)


@contextmanager
def _opened(path: str | Path) -> Iterator[netCDF4.Dataset]:
    """Open a netCDF file to read it. Raises RecordError, also if reading in the block fails."""
    try:
        with netCDF4.Dataset(path) as file:
            yield file
    except (OSError, RuntimeError) as error:  # netCDF4 gives the latter for damaged data
        raise RecordError(f"{path}: cannot be read as netCDF ({error}): {MAKE_AGAIN}") from error


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
    """Return the global attributes of a file of write_record. Raises RecordError."""
    with _opened(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


def read_given_dataset(path: str | Path, described: Iterable[str] = ()) -> xr.Dataset:
    """Return the dataset of a netCDF file that a user gives, in any state.

    described: variables whose values are not read: zeros of their shape and type stand for them.

    Texts are decoded and packed numbers unpacked; no variable is taken for a date. The time of a
    record is called `time`, as in read_record. Raises RecordError for whatever can not be read.
    """
    place = Path(path)
    if not place.is_file():
        raise RecordError(f"{path}: is no file: give the path of a netCDF file")
    with _foreign(path, "netCDF"):
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


def _require_plausible_size(dataset: xr.Dataset, path: Path) -> None:
    """Raise RecordError if the variables of a file are far larger than the file.

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


def read_numeric_variables(
    path: str | Path,
) -> tuple[dict[str, np.ndarray], dict[str, str], dict[str, Any]]:
    """Return (numbers, units, global attributes) of any netCDF file: its variables of the root.

    numbers {name: array of float}: scaled; masked values are NaN.
    units {name: text}: of the variables that state one, a time as it is written.

    Raises RecordError for a file that is damaged, refers to another file or claims more numbers
    than it can hold.
    """
    with _foreign(path, "netCDF"):
        with netCDF4.Dataset(path) as file:
            numeric = {
                name: variable
                for name, variable in file.variables.items()
                if isinstance(variable.datatype, np.dtype) and variable.datatype.kind in "fiu"
            }
            classic = file.data_model.startswith("NETCDF3")
            _refuse_size(path, numeric, 1 if classic else MOST_PACKED)
            if classic:
                _refuse_cut(path)
            values = {
                name: np.ma.filled(np.ma.asarray(variable[...]).astype(float), np.nan)
                for name, variable in numeric.items()
            }
            units = {
                name: str(variable.getncattr("units"))
                for name, variable in numeric.items()
                if "units" in variable.ncattrs()
            }
            return values, units, {name: file.getncattr(name) for name in file.ncattrs()}


def read_hdf5_arrays(path: str | Path) -> dict[str, np.ndarray]:
    """Return the numeric arrays of an HDF5 file as MATLAB v7.3 writes it.

    Keys are group.name; axes are in MATLAB's order. Raises RecordError as read_numeric_variables.
    """
    # Imported here: it brings an HDF5 library of its own, which other stages do not need.
    import h5py

    found: dict[str, Any] = {}

    def collect(name, item):
        if (
            not isinstance(item, h5py.Dataset)
            or item.dtype.kind not in "fiu"
            or name.startswith("#")
            or "MATLAB_empty" in item.attrs
            or item.attrs.get("MATLAB_class") in (b"char", b"logical")
        ):
            return
        label = name.replace("/", ".")
        if label in found:
            raise RecordError(f"{path}: holds '{label}' twice: rename one of the two")
        found[label] = item

    with _foreign(path, "HDF5"):
        with h5py.File(path, "r") as file:
            file.visititems(collect)
            _refuse_size(path, found, MOST_PACKED)
            return {name: np.asarray(item[()]).T for name, item in found.items()}


@contextmanager
def _foreign(path: str | Path, kind: str) -> Iterator[None]:
    """Turn whatever a library raises on a damaged file into a RecordError, and refuse damage that
    it does not see.
    """
    try:
        # netCDF4 warns if it leaves out an attribute that would change the values.
        with warnings.catch_warnings(action="error", category=UserWarning):
            if is_hdf5(path):
                inspect_hdf5(path)
            yield
    except RecordError:
        raise
    except Exception as error:
        cause = error.__cause__ or error
        why = (str(cause).splitlines() or [type(cause).__name__])[0]
        raise RecordError(
            f"{path}: can not be read as {kind} ({why}): the file is damaged or of another kind,"
            " export it again"
        ) from error


def _refuse_cut(path: str | Path) -> None:
    """Raise an exception for a netCDF-3 file that is cut short; the netCDF library reads zeros."""
    from scipy.io import netcdf_file  # imported here: half a second that other files save

    if Path(path).read_bytes()[:4] != b"CDF\5":  # the one kind that scipy does not read
        netcdf_file(path, mmap=False).close()


def _refuse_size(path: str | Path, arrays: Mapping[str, Any], packing: int) -> None:
    """Raise RecordError if arrays of a file claim more numbers than it holds or than are read.

    arrays: anything with shape and dtype. packing: the most that the format compresses.
    """
    most = packing * os.path.getsize(path)
    for name, array in arrays.items():
        claimed = math.prod(array.shape) * array.dtype.itemsize
        if claimed > most:
            raise RecordError(
                f"{path}: '{name}' claims {claimed:.3g} bytes, more than the file can hold: it is"
                " damaged or was cut short, export it again"
            )
    total = FLOAT_BYTES * sum(math.prod(array.shape) for array in arrays.values())
    if total > MOST_READ:
        raise RecordError(
            f"{path}: holds {total:.3g} bytes of numbers, at most {MOST_READ:.0e} are read from one"
            " file: store fewer signals or a shorter record in each"
        )


def write_table(rows: list[dict], path: str | Path, columns: tuple[str, ...] = ()) -> None:
    """Write rows with the same keys as CSV, whole or not at all.

    Floats are written in full precision, NaN as 'nan'.

    columns: the header of a table that may have no rows.
    """
    columns = tuple(rows[0]) if rows else tuple(columns)
    write_cells(columns, ([row[column] for column in columns] for row in rows), path)


def write_cells(columns: Iterable[str], rows: Iterable, path: str | Path) -> None:
    """Write rows of values under a header as CSV, whole or not at all.

    A text that a spreadsheet would take for a formula gets an apostrophe in front, which read_table
    takes away.

    Raises RecordError if the folder cannot be written or is full.
    """
    with whole_file(path) as temporary, open(temporary, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows([_cell(value) for value in row] for row in rows)


def write_text(text: str, path: str | Path) -> None:
    """Write a text file, whole or not at all.

    Raises RecordError if the folder cannot be written or is full.
    """
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def read_table(path: str | Path, texts: Iterable[str] = ()) -> list[dict[str, Any]]:
    """Return the rows of a CSV table of write_table; text that reads as a number becomes one.

    texts: columns whose values stay texts: a name may read as a number.

    Raises RecordError when there is no such file, it is empty, or a row is not whole.
    """
    try:
        columns, *rows = list(csv.reader(io.StringIO(read_text(path), newline=""))) or [[]]
    except csv.Error as error:
        raise RecordError(f"{path}: is not a CSV table ({error}): {MAKE_AGAIN}") from error
    if not columns:
        raise RecordError(f"{path}: is empty: {MAKE_AGAIN}")
    for number, row in enumerate(rows, start=2):
        if len(row) != len(columns):
            raise RecordError(
                f"{path}: row {number} has {len(row)} values for {len(columns)} columns:"
                f" {MAKE_AGAIN}"
            )
    kinds = [_text if column in texts else _number for column in columns]
    return [
        {column: kind(text) for column, kind, text in zip(columns, kinds, row, strict=True)}
        for row in rows
    ]


def _cell(value):
    """Return a value as it is written; as text, a formula would be computed by a spreadsheet."""
    if isinstance(value, np.floating):  # csv writes a float in full, a float32 in few digits
        return float(value)
    formula = isinstance(value, str) and FORMULA.match(value) and isinstance(_number(value), str)
    return f"'{value}" if formula else value


def _text(text):
    """Return the text of a cell of _cell."""
    return text[1:] if text.startswith("'") and FORMULA.match(text) else text


def _number(text):
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return _text(text)


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
