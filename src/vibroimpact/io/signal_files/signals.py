"""A recorded signal as a file gives it, and its resampling to even time steps."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

TIME_NAMES = ("time", "t", "time_s", "time (s)", "time [s]", "zeit")
# Files of recorders that are not read, by the end of their name: their kind, and the remedy.
UNREAD = {
    ".lvm": "is a LabVIEW measurement file, which is not read: save its table as CSV, with one line"
    " of names above it, or convert it with the Python package lvm_read",
    ".tdms": "is a TDMS file of National Instruments, which is not read: export it as CSV or"
    " MATLAB, or convert it with the Python package npTDMS",
    ".mf4": "is an ASAM MDF file, which is not read: export it as CSV or MATLAB, or convert it with"
    " the Python package asammdf",
    ".wav": "is a sound file, which has no units: export it as MATLAB or UFF",
    ".txt": "is a text file: if it holds a table, rename it to .csv",
    ".xlsx": "is a workbook, which is not read: save its sheet as CSV",
}
for alike, known in ((".mdf", ".mf4"), (".asc", ".txt"), (".dat", ".txt"), (".xls", ".xlsx")):
    UNREAD[alike] = UNREAD[known]
RATE_NAMES = ("Fs", "fs", "sampling_frequency", "sampling_frequency_Hz", "sample_rate")
EVEN_WITHIN = 0.05  # steps: scatter of time stamps about an even grid
LOST_SAMPLE = 1.5  # steps: a longer interval means that samples are missing
COARSEST = 0.6  # steps: of time stamps that are rounded, not uneven
WHOLE_WITHIN = 5.0e-6  # relative: a rate printed with six digits stands for a whole number of Hz


class ImportProblem(Exception):
    """Files that can not be made into a campaign.

    The message holds every problem and its remedy, one per line.
    """


@dataclass(frozen=True)
class Signal:
    """One signal of one file.

    name: as the sidecar refers to it.
    file: path.
    values (time,): in `unit`.
    rate: Hz, None if the file does not state it.
    unit, kind, point (3,) m, direction (3,), force: as the file states them, else "" or None.
    unit_from: the place of the unit in the file.
    aliases: other names of the signal.
    note: how the file was read and its values were changed.
    start: s, of the first sample; None if the file has no time.
    lines (time,): line of the file that holds a sample, None if the file has none.
    left_out: {name: why} of the other contents of the file, in words that follow the name.
    """

    name: str
    file: str
    values: np.ndarray
    rate: float | None
    unit: str = ""
    unit_from: str = ""
    kind: str = ""
    direction: tuple | None = None
    point: tuple | None = None
    force: bool = False
    aliases: tuple = ()
    note: str = ""
    start: float | None = None
    lines: np.ndarray | None = None
    left_out: Mapping[str, str] = field(default_factory=dict)

    def place(self, sample: int) -> str:
        """Return the place of a sample: "low.csv, line 38, column tip" or "low.mat, tip[38]"."""
        file = Path(self.file).name
        if self.lines is not None and sample < len(self.lines):
            return f"{file}, line {self.lines[sample]}, column {self.name}"
        return f"{file}, {self.name}, sample {sample} (from 0)"


def even_samples(time: np.ndarray, values: np.ndarray, place: str) -> tuple[np.ndarray, float, str]:
    """Return (values (..., time), rate in Hz, note) on an even grid.

    time (time,): time stamps, s.
    values (..., time).
    place: file and signal, for messages.

    Stamps count as even if they scatter by less than a twentieth of a step, by less than their
    six printed digits, or by the digits that they are rounded to. Others are interpolated by a
    cubic spline at the mean step, and the note says so. Raises ImportProblem for lost samples or
    stamps that do not increase.
    """
    time = np.asarray(time, float)
    steps = np.diff(time) if np.all(np.isfinite(time)) else np.zeros(0)
    typical = float(np.median(steps)) if steps.size else 0.0
    if not 0.0 < typical < np.inf:
        raise ImportProblem(
            f"{place}: the time does not rise, or is no number throughout: correct the file, or"
            " leave the time out of it and give sampling_frequency_Hz in campaign.yaml"
        )
    printed = 1.05 * 10.0 ** (np.floor(np.log10(max(np.abs(time).max(), 1e-300))) - 5.0)
    rounded = _rounding(time, typical)
    digits, printed = 1.05 * rounded > printed, max(printed, 1.05 * rounded)
    if np.any(steps > LOST_SAMPLE * typical + 2.0 * printed) or np.any(steps < -2.0 * printed):
        index = int(np.argmax(np.abs(steps - typical)))
        raise ImportProblem(
            f"{place}: a step of {steps[index]:.4g} s after {time[index]:.6g} s, elsewhere"
            f" {typical:.4g} s: samples are lost; cut the record there with from_s and to_s of"
            " campaign.yaml"
        )
    step = (time[-1] - time[0]) / (time.size - 1)
    grid = time[0] + step * np.arange(time.size)
    rate = whole_rate(1.0 / step, rounded / (step * time.size))
    off = np.max(np.abs(time - grid))
    if off <= max(EVEN_WITHIN * step, printed):
        told = digits and off > EVEN_WITHIN * step
        note = f"times are rounded to {rounded:g} s: taken as even, at {rate:g} Hz" if told else ""
        return values, rate, note
    holes = np.argwhere(~np.isfinite(values))
    if holes.size or np.any(steps <= 0.0):
        where = f"sample {holes[0][-1]} is no number" if holes.size else "two samples share a time"
        raise ImportProblem(
            f"{place}: unevenly sampled, and {where} (samples from 0): interpolate the record to"
            " even steps first"
        )
    from scipy.interpolate import CubicSpline  # half a second that others save

    even = CubicSpline(time, values, axis=-1)(grid)
    return even, rate, f"unevenly sampled: interpolated to {rate:g} Hz"


def _rounding(time: np.ndarray, step: float) -> float:
    """Return the power of ten in s that time stamps (time,) are rounded to if they have the
    fewest decimals, at the end; 0 if it is finer than six digits or no small part of a step.
    """
    largest = np.abs(time).max()
    late = time[np.abs(time) >= 10.0 ** np.floor(np.log10(max(largest, 1e-300)))]
    for decimals in range(10):
        unit = 10.0**-decimals
        if unit < COARSEST * step and np.all(np.abs(late / unit - np.round(late / unit)) < 1e-3):
            return unit if unit > 1e-5 * largest else 0.0
    return 0.0


def whole_rate(rate: float, within: float = 0.0) -> float:
    """Return a sampling frequency in Hz, whole if it is so to six digits, or within a share."""
    whole = abs(rate - round(rate)) < max(WHOLE_WITHIN, within) * rate
    return float(round(rate)) if whole else float(rate)
