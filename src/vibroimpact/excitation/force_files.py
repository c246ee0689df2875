"""Reading a measured force from netCDF, CSV or MATLAB files."""

import csv
from collections import Counter
from pathlib import Path

import numpy as np

from vibroimpact.foreign_arrays import ForeignFileError, refused_if_damaged
from vibroimpact.matlab_files import load_matlab
from vibroimpact.records import RecordError, read_numeric_variables

TIME_NAMES = ("time", "t", "time_s")
RATE_NAMES = ("Fs", "fs", "sampling_frequency", "sampling_frequency_Hz")
LARGEST_N = 1e20


class ForceFileError(ForeignFileError):
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

    Raises ForceFileError when the file or variable is missing, its kind is unknown, it is damaged,
    it has no sampling frequency or holds values that are not finite, or 0 throughout.
    """
    path = Path(path)
    readers = {".nc": _from_netcdf, ".csv": _from_csv, ".mat": _from_matlab}
    if path.suffix.lower() not in readers:
        raise ForceFileError(f"{path}: unknown kind '{path.suffix}': give a .nc, .csv or .mat file")
    if not path.is_file():
        raise ForceFileError(f"{path}: no such file: check excitation.file")
    try:
        with refused_if_damaged(path, "netCDF, CSV or MATLAB by its ending", "export it again"):
            values, rate = readers[path.suffix.lower()](path, variable)
            values = _one_record(path, variable, values)
    except ForceFileError:
        raise
    except ForeignFileError as error:
        raise ForceFileError(str(error)) from error
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


def _one_record(path, variable, values):
    """Return the values of a variable as (sample,) of float. Raises ForceFileError."""
    if getattr(values, "dtype", np.dtype(object)).kind not in "fiu" or not hasattr(values, "ravel"):
        raise ForceFileError(f"{path}: {variable} holds no real numbers: give a column of forces")
    values = np.asarray(values, float).squeeze()
    if values.ndim != 1 or values.size < 2:
        raise ForceFileError(
            f"{path}: {variable} has shape {values.shape}, one record of many samples is needed"
        )
    odd = ~(np.abs(values) <= LARGEST_N)  # true for what is not a number, too
    if odd.any():
        raise ForceFileError(
            f"{path}: {variable}[{np.argmax(odd)}] is not finite or beyond any force: cut or repair"
            " the record"
        )
    if not values.any():
        raise ForceFileError(f"{path}: {variable} is 0 throughout: give the record of a force")
    return values


def _pick(path, known, variable):
    """Return a variable among those known by name. Raises ForceFileError."""
    if variable not in known:
        names = ascii(", ".join(sorted(known)) or "none")[1:-1]
        raise ForceFileError(f"{path}: no variable '{variable}': it has {names[:200]}")
    return known[variable]


def _stated_rate(path, known):
    """Return the sampling frequency in Hz that stands among named values, None without one.

    Raises ForceFileError.
    """
    for name in RATE_NAMES:
        if name in known:
            rate = np.asarray(known[name])
            if rate.size != 1 or rate.dtype.kind not in "fiu" or not 0 < rate.item() <= 1e9:
                raise ForceFileError(
                    f"{path}: its {name} is no frequency in Hz: correct it, or take it out and give"
                    " excitation.sampling_frequency_Hz"
                )
            return float(rate.item())
    return None


def _rate_of(time, path):
    """Return the sampling frequency in Hz of evenly spaced times in s. Raises ForceFileError."""
    steps = np.diff(np.asarray(time, float).squeeze())
    if steps.ndim != 1 or not (
        steps.size and np.all(steps > 1e-9) and np.ptp(steps) <= 1e-3 * np.mean(steps)
    ):
        raise ForceFileError(
            f"{path}: the time column is not evenly spaced: resample the record first"
        )
    return 1.0 / np.mean(steps)


def _from_netcdf(path, variable):
    try:
        known, *_, attributes = read_numeric_variables(path)
    except RecordError as error:
        raise ForceFileError(str(error)) from error
    values = _pick(path, known, variable)
    time = next((known[name] for name in TIME_NAMES if name in known), None)
    rate = _stated_rate(path, attributes)
    return values, rate or (_rate_of(time, path) if time is not None else None)


def _from_csv(path, variable):
    text = _text(path)
    lines = [line for line in text.splitlines() if line.strip()]
    if len(lines) < 2:
        raise ForceFileError(f"{path}: holds no numbers under a header line: export it again")
    header = next(csv.reader([lines[0].lstrip("# ")]), [])
    twice = [name for name, times in Counter(name.strip() for name in header).items() if times > 1]
    if twice:
        raise ForceFileError(f"{path}: two columns are named '{twice[0][:60]}': rename one")
    try:
        table = np.genfromtxt(lines, delimiter=",", names=True, dtype=float, comments="#")
    except ValueError as error:
        raise ForceFileError(
            f"{path}: not a table of numbers under one header line: give every line as many numbers"
            " as the header has names"
        ) from error
    known = {name: table[name] for name in table.dtype.names or ()}
    time = next((known[name] for name in TIME_NAMES if name in known), None)
    return _pick(path, known, variable), _rate_of(time, path) if time is not None else None


def _text(path):
    """Return the text of a table in UTF-8, or else in Latin-1. Raises ForceFileError."""
    raw = path.read_bytes()
    if b"\0" in raw:
        raise ForceFileError(f"{path}: is a binary file: export the force as text, .nc or .mat")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _from_matlab(path, variable):
    content = load_matlab(path)
    return _pick(path, content, variable), _stated_rate(path, content)
