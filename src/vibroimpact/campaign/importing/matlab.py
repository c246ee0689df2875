"""Signals of MATLAB files, of version 5 or 7.3."""

from __future__ import annotations

from pathlib import Path

from vibroimpact.records import RecordError, is_hdf5, read_hdf5_arrays

from .arrays import Arrays, signals_of_arrays
from .matlab_5 import read_matlab_5
from .signals import ImportProblem, Signal


def read_matlab(path: str | Path) -> list[Signal]:
    """Return the Signals of a MAT file, v5 or v7.3.

    Fields of structures are named structure.field. The rate is Fs, or follows from a time vector.
    Raises ImportProblem.
    """
    try:
        columns = read_hdf5_arrays(path) if is_hdf5(path) else read_matlab_5(path)
    except RecordError as error:
        raise ImportProblem(str(error)) from error
    return signals_of_arrays(Arrays(path, columns))
