"""Reading a measured force from netCDF, CSV or MATLAB files."""

from pathlib import Path

import numpy as np

from vibroimpact.records import read_numeric_variables

TIME_NAMES = ("time", "t", "time_s")
RATE_NAMES = ("Fs", "fs", "sampling_frequency", "sampling_frequency_Hz")


class ForceFileError(Exception):
    """A force file that cannot be read; the message names it, what is wrong and the remedy."""


def read_force(
    path: str | Path, variable: str, sampling_frequency: float | None
) -> tuple[np.ndarray, float]:
    """Return (values (sample,) in N, sampling frequency in Hz) of one variable of a file.

    The file brings its sampling frequency:

    - netCDF (.nc): an attribute `sampling_frequency`, or a time coordinate;
    - CSV (.csv) with a header line: a column "time";
    - MATLAB v5 (.mat): a variable `Fs`.

    sampling_frequency: Hz, for a file that has none; it must agree where the file has one.

    Raises ForceFileError when the file or variable is missing, its kind is unknown, it has no
    sampling frequency or holds values that are not finite.
    """
    path = Path(path)
    readers = {".nc": _from_netcdf, ".csv": _from_csv, ".mat": _from_matlab}
    if path.suffix.lower() not in readers:
        raise ForceFileError(f"{path}: unknown kind '{path.suffix}': give a .nc, .csv or .mat file")
    if not path.is_file():
        raise ForceFileError(f"{path}: no such file: check excitation.file")
    values, rate = readers[path.suffix.lower()](path, variable)
    values = np.asarray(values, float).squeeze()
    if values.ndim != 1 or values.size < 2:
        raise ForceFileError(
            f"{path}: {variable} has shape {values.shape}, one record of many samples is needed"
        )
    if not np.all(np.isfinite(values)):
        raise ForceFileError(
            f"{path}: {variable}[{np.flatnonzero(~np.isfinite(values))[0]}] is not finite: cut or"
            " repair the record"
        )
    if rate and sampling_frequency and abs(rate - sampling_frequency) > 1e-6 * rate:
        raise ForceFileError(
            f"{path}: sampled at {rate:g} Hz, but excitation.sampling_frequency_Hz ="
            f" {sampling_frequency:g}: remove the key"
        )
    found = rate or sampling_frequency
    if not found:
        raise ForceFileError(
            f"{path}: says no sampling frequency: give excitation.sampling_frequency_Hz"
        )
    return values, float(found)


def _pick(path, known, variable):
    """Return a variable among those known by name. Raises ForceFileError."""
    if variable not in known:
        raise ForceFileError(
            f"{path}: no variable '{variable}': it has {', '.join(sorted(known)) or 'none'}"
        )
    return known[variable]


def _rate_of(time, path):
    """Return the sampling frequency in Hz of evenly spaced times in s. Raises ForceFileError."""
    steps = np.diff(np.asarray(time, float).squeeze())
    if not np.all(steps > 0.0) or np.ptp(steps) > 1e-3 * np.mean(steps):
        raise ForceFileError(
            f"{path}: the time column is not evenly spaced: resample the record first"
        )
    return 1.0 / np.mean(steps)


def _from_netcdf(path, variable):
    known, _, attributes = read_numeric_variables(path)
    values = _pick(path, known, variable)
    rate = next((float(attributes[name]) for name in RATE_NAMES if name in attributes), None)
    time = next((known[name] for name in TIME_NAMES if name in known), None)
    return values, rate or (_rate_of(time, path) if time is not None else None)


def _from_csv(path, variable):
    try:
        table = np.genfromtxt(path, delimiter=",", names=True, dtype=float, comments="#")
    except ValueError as error:
        raise ForceFileError(
            f"{path}: not a table of numbers under one header line ({error})"
        ) from error
    known = {name: table[name] for name in table.dtype.names or ()}
    time = next((known[name] for name in TIME_NAMES if name in known), None)
    return _pick(path, known, variable), _rate_of(time, path) if time is not None else None


def _from_matlab(path, variable):
    from scipy.io import loadmat  # imported here: half a second that other formats save

    content = {name: value for name, value in loadmat(path).items() if not name.startswith("__")}
    rate = next((float(np.squeeze(content[name])) for name in RATE_NAMES if name in content), None)
    return _pick(path, content, variable), rate
