"""Signals of CSV, netCDF and MATLAB files (v5 through scipy, v7.3 through h5py)."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from vibroimpact.records import RecordError, read_dataset, read_hdf5_arrays

from .signals import RATE_NAMES, TIME_NAMES, ImportProblem, Signal, even_samples

HEADER_UNIT = re.compile(r"\s*(.*?)\s*[\[(]\s*([^\])]+?)\s*[\])]\s*")  # acc top [m/s^2]
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
HDF5_PLACES = (0, 512, 1024, 2048)


def read_csv(path: str | Path) -> list[Signal]:
    """Return the Signals of a CSV file.

    It has one header line with names, "name" or "name [unit]"; a column "time" gives the sampling.
    The separator is a comma, semicolon or tab. Raises ImportProblem where a line does not fit.
    """
    lines = [
        line
        for line in Path(path).read_text(encoding="utf-8-sig").splitlines()
        if line.strip() and not line.startswith("#")
    ]
    if len(lines) < 3:
        raise ImportProblem(
            f"{path}: holds no table: a header line with names, then one line per sample"
        )
    separator = max(",;\t", key=lines[0].count)
    names = [name.strip().strip('"') for name in lines[0].split(separator)]
    try:
        table = np.array([[float(cell) for cell in line.split(separator)] for line in lines[1:]])
    except ValueError as error:
        raise ImportProblem(
            f"{path}: not a table of numbers with a point as decimal sign under one header line"
            f" ({error})"
        ) from error
    if table.ndim != 2 or table.shape[1] != len(names):
        raise ImportProblem(
            f"{path}: {len(names)} names in the header over {table.shape[-1]} columns"
        )
    parts = [HEADER_UNIT.fullmatch(name) for name in names]
    plain = [part[1] if part else name for part, name in zip(parts, names, strict=True)]
    columns = {name: table[:, index] for index, name in enumerate(plain)}
    units = {name: part[2] for name, part in zip(plain, parts, strict=True) if part}
    return _signals(path, columns, units, "header of the file", {})


def read_netcdf(path: str | Path) -> list[Signal]:
    """Return the Signals of a netCDF file of any layout.

    They are the variables whose last dimension is time; their attribute `units` gives the unit.
    """
    try:
        dataset = read_dataset(path)
    except RecordError as error:
        raise ImportProblem(str(error)) from error
    columns = {
        str(name): variable.values
        for name, variable in dataset.variables.items()
        if variable.dtype.kind in "fiu"
    }
    units = {
        name: str(dataset[name].attrs["units"])
        for name in columns
        if dataset[name].attrs.get("units")
    }
    return _signals(path, columns, units, "attribute units", dict(dataset.attrs))


def read_matlab(path: str | Path) -> list[Signal]:
    """Return the Signals of a MAT file, v5 or v7.3.

    Fields of structures are named structure.field. The rate is Fs, or follows from a time vector.
    """
    with open(path, "rb") as file:
        head = file.read(HDF5_PLACES[-1] + 8)
    if any(head[place : place + 8] == HDF5_SIGNATURE for place in HDF5_PLACES):
        try:
            columns = read_hdf5_arrays(path)
        except RecordError as error:
            raise ImportProblem(str(error)) from error
    else:
        columns = _matlab_5(path)
    return _signals(path, columns, {}, "", {})


def _matlab_5(path):
    from scipy.io import loadmat  # imported here: other files do not need it
    from scipy.io.matlab import MatReadError

    try:
        content = loadmat(path, simplify_cells=True)
    except (MatReadError, ValueError, NotImplementedError, OSError) as error:
        raise ImportProblem(f"{path}: can not be read as a MAT file ({error})") from error
    return dict(
        _flat({name: value for name, value in content.items() if not name.startswith("__")})
    )


def _flat(content, prefix=""):
    """Yield (name, array) of the numbers in nested dicts."""
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        elif isinstance(value, (int, float)) or (
            isinstance(value, np.ndarray) and value.dtype.kind in "fiu"
        ):
            yield f"{prefix}{name}", np.asarray(value)


def _signals(path, columns, units, unit_from, attributes):
    """Return a Signal for every row of the arrays that have the sampling of the file.

    Rows of an array are named name[index], from 0, where it has several.
    """
    rate = next(
        (
            float(np.squeeze(columns[name]))
            for name in RATE_NAMES
            if name in columns and np.size(columns[name]) == 1
        ),
        None,
    )
    rate = rate or next(
        (float(attributes[name]) for name in RATE_NAMES if name in attributes), None
    )
    stamps = next((name for name in columns if name.lower() in TIME_NAMES), None)
    time = None if stamps is None or rate else np.ravel(columns[stamps])
    arrays = {
        name: _rows(values)
        for name, values in columns.items()
        if name != stamps and name not in RATE_NAMES and np.size(values) > 1
    }
    longest = max((rows.shape[-1] for rows in arrays.values()), default=0)
    found = []
    for name, rows in arrays.items():
        if rows.shape[-1] != longest:
            continue
        note = ""
        if time is not None and time.size == longest:
            rows, rate, note = even_samples(time, rows, f"{path}, {name}")
        for index, row in enumerate(rows):
            label = name if len(rows) == 1 else f"{name}[{index}]"
            stated_in = unit_from if name in units else ""
            found.append(
                Signal(label, str(path), row, rate, units.get(name, ""), stated_in, note=note)
            )
    return found


def _rows(values):
    """Return (signal, time) of an array: its longest axis last, all others flattened."""
    values = np.squeeze(np.asarray(values, float))
    if values.ndim == 0:
        return values.reshape(1, 1)
    values = np.moveaxis(values, int(np.argmax(values.shape)), -1)
    return values.reshape(-1, values.shape[-1])
