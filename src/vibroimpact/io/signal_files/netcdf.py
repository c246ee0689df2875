"""Signals of a netCDF file."""

from __future__ import annotations

from pathlib import Path

from vibroimpact.io.records import TIME, TIME_IN_FILE, RecordError, read_numeric_variables

from .arrays import Arrays, signals_of_arrays
from .signals import ImportProblem, Signal


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
