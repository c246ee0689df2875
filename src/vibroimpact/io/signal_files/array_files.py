"""Signals of files that hold named arrays: MATLAB of version 4 to 7.3, and netCDF."""

from pathlib import Path

import numpy as np

from vibroimpact.io.foreign_arrays import ForeignFileError
from vibroimpact.io.hdf5 import is_hdf5
from vibroimpact.io.matlab_files import load_matlab
from vibroimpact.io.records import (
    MOST_READ,
    TIME,
    TIME_IN_FILE,
    RecordError,
    read_hdf5_arrays,
    read_numeric_variables,
)

from .arrays import Arrays, signals_of_arrays
from .signals import ImportProblem, Signal


def read_matlab(path: str | Path) -> list[Signal]:
    """Return the Signals of a MAT file: its dense arrays of real numbers.

    Fields of structures are named structure.field. The rate is Fs, or follows from a time vector.
    Raises ImportProblem.
    """
    try:
        found = read_hdf5_arrays(path) if is_hdf5(path) else load_matlab(path, MOST_READ)
    except (RecordError, ForeignFileError) as error:
        raise ImportProblem(str(error)) from error
    columns = {
        name: values
        for name, values in found.items()
        if isinstance(values, np.ndarray) and values.dtype.kind in "fiu"
    }
    left_out = {name: "holds no real numbers" for name in found if name not in columns}
    return signals_of_arrays(Arrays(path, columns, left_out=left_out))


def read_netcdf(path: str | Path) -> list[Signal]:
    """Return the Signals of a netCDF file of any layout.

    They are the variables whose longest dimension is time; their attribute `units` gives the unit.
    Raises ImportProblem.
    """
    try:
        columns, units, attributes = read_numeric_variables(path)
    except RecordError as error:
        raise ImportProblem(str(error)) from error
    for known in (columns, units):
        if TIME_IN_FILE in known and TIME not in known:
            known[TIME] = known.pop(TIME_IN_FILE)  # type: ignore[assignment]
    return signals_of_arrays(Arrays(path, columns, units, "attribute units", attributes))
