"""Reading a measured force from netCDF, CSV or MATLAB files, and whether it lasts for a case."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vibroimpact.io.foreign_arrays import ForeignFileError, refused_if_damaged
from vibroimpact.io.signal_files.array_files import read_matlab, read_netcdf
from vibroimpact.io.signal_files.csv_table import read_csv
from vibroimpact.io.signal_files.signals import ImportProblem, Signal
from vibroimpact.io.units import UnitError, si_factor

READERS = {".nc": read_netcdf, ".csv": read_csv, ".mat": read_matlab}
LARGEST_N = 1e20
MOST_STEPS_APART = 1000  # integration steps between two samples: a force of 51 Hz at 51200 steps/s
LEAST_SHARE = 1e-3  # of the RMS of the whole force: less in the record is the round-off of its end


class ForceFileError(ForeignFileError):
    """A force file that cannot be read; the message names it, the fault and the remedy."""


@dataclass(frozen=True)
class MeasuredForce:
    """A force as its file gives it.

    values (sample,): N. rate: Hz. note: how the file was read, "" if as it stands.
    """

    values: np.ndarray
    rate: float
    note: str = ""

    def described(self) -> str:
        """Return the rate and duration in words."""
        told = f"{self.values.size / self.rate:.6g} s at {self.rate:.6g} Hz"
        return f"{told} ({self.note})" if self.note else told


def read_force(path: str | Path, variable: str, sampling_frequency: float | None) -> MeasuredForce:
    """Return one variable of a file, read as those of a measured campaign are.

    The file brings its sampling frequency: an attribute or variable `Fs` or `sampling_frequency`,
    or times, whose unit counts (netCDF attribute `units`, CSV column "time [ms]").

    sampling_frequency: Hz, for a file that has none; it must agree if the file has one.

    Raises ForceFileError when the file or variable is missing, its kind is unknown, it is damaged,
    it has no sampling frequency or two that differ, or holds values that are not finite, or 0
    throughout.
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise ForceFileError(f"{path}: unknown kind '{path.suffix}': give a .nc, .csv or .mat file")
    if not path.is_file():
        raise ForceFileError(f"{path}: no such file: check excitation.file")
    try:
        with refused_if_damaged(path, "netCDF, CSV or MATLAB by its ending", "export it again"):
            try:
                signal = _named(path, reader(path), variable)
            except ImportProblem as problem:
                raise ForceFileError(str(problem)) from problem
    except ForeignFileError as error:
        raise ForceFileError(str(error)) from error
    values = _newtons(path, variable, signal)
    rate = signal.rate
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
    return MeasuredForce(values, float(found), signal.note)


def _named(path: Path, signals: list[Signal], variable: str) -> Signal:
    """Return the signal of a name. Raises ForceFileError."""
    for signal in signals:
        if signal.name == variable:
            return signal
    if signals and (reason := signals[0].left_out.get(variable)):
        raise ForceFileError(f"{path}: {variable} {reason}: give one record of many real numbers")
    names = ascii(", ".join(sorted(signal.name for signal in signals)))[1:-1]
    raise ForceFileError(f"{path}: no variable '{variable}': it has {names[:200]}")


def _newtons(path: Path, variable: str, signal: Signal) -> np.ndarray:
    """Return the values (sample,) of a signal in N; without a unit they are. Raises
    ForceFileError.
    """
    try:
        values = signal.values * (si_factor(signal.unit, "force") if signal.unit else 1.0)
    except UnitError as error:
        raise ForceFileError(f"{path}: {variable} {error}") from error
    odd = ~(np.abs(values) <= LARGEST_N)  # true for NaN, too
    if odd.any():
        raise ForceFileError(
            f"{path}: {variable}[{np.argmax(odd)}] is not finite or beyond any force: cut or repair"
            " the record"
        )
    if not values.any():
        raise ForceFileError(f"{path}: {variable} is 0 throughout: give the record of a force")
    return values


def require_lasting(
    path: str | Path, force: MeasuredForce, rate: float, start_up_s: float, needed_s: float
) -> None:
    """Raise ForceFileError if a force is not that of a case.

    rate: Hz, of the integration. start_up_s: s, before the record. needed_s: s, of both.

    It is too short, ends within the start-up, or its samples are so far apart that its times are
    hardly in seconds.
    """
    samples = force.values
    if rate > MOST_STEPS_APART * force.rate:
        raise ForceFileError(
            f"{path}: its samples are {1 / force.rate:.4g} s apart, {rate / force.rate:.4g}"
            f" integration steps (at most {MOST_STEPS_APART}): are its times in ms? Name the column"
            ' "time [ms]", or give a netCDF time the attribute units = "ms"; or resample it'
        )
    if samples.size / force.rate < needed_s * (1.0 - 1e-9):
        raise ForceFileError(
            f"{path}: lasts {samples.size / force.rate:.3f} s, but start-up and record need"
            f" {needed_s:.3f} s: lower integration.start_up_s or record.duration_s"
        )
    recorded = samples[round(start_up_s * force.rate) : round(needed_s * force.rate)]
    left, whole = (float(np.sqrt(np.mean(part**2))) for part in (recorded, samples))
    if left < LEAST_SHARE * whole:
        raise ForceFileError(
            f"{path}: the force ends within the start-up of {start_up_s:g} s: the record would hold"
            f" {left:.3g} of {whole:.3g} N RMS: lower integration.start_up_s,"
            " or cut the file"
        )
