"""Signals of a file that holds named arrays: which of them are signals, and their sampling."""

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.io.units import UnitError, si_factor

from .signals import RATE_NAMES, TIME_NAMES, ImportProblem, Signal, even_samples

SINCE = re.compile(r"\s+since\s.*", re.DOTALL)  # of a time such as "seconds since 2000-01-01"
SAME_RATE = 1e-3  # relative


@dataclass(frozen=True)
class Arrays:
    """The content of a file.

    path: of the file.
    columns {name: array}: numbers.
    units {name: text}, unit_from: units of the columns, and their places in the file.
    attributes: of the file.
    note: how the file was read.
    lines (time,): line of the file that holds a sample, None if there are no lines.
    left_out {name: why}: the other contents of the file, in words that follow the name.
    """

    path: str | Path
    columns: dict[str, np.ndarray]
    units: dict[str, str] = field(default_factory=dict)
    unit_from: str = ""
    attributes: dict[str, Any] = field(default_factory=dict)
    note: str = ""
    lines: np.ndarray | None = None
    left_out: dict[str, str] = field(default_factory=dict)


def signals_of_arrays(arrays: Arrays) -> list[Signal]:
    """Return a Signal for every row of the arrays that have the sampling of the file.

    Rows of an array are named name[index], from 0, if it has several. Raises ImportProblem if
    there is none, or if the sampling frequency and the time disagree.
    """
    stated = _stated_rate(arrays)
    stamps = next((name for name in arrays.columns if name.lower() in TIME_NAMES), None)
    time = None if stamps is None else _seconds(arrays, stamps)
    signals = {
        name: _rows(values)
        for name, values in arrays.columns.items()
        if name != stamps and name not in RATE_NAMES and np.size(values) > 1
    }
    longest, left_out = _of_other_length(arrays, signals)
    found = []
    for name, rows in signals.items():
        if name in left_out:
            continue
        rate, notes, start = stated, [arrays.note], None
        if time is not None and time.size == longest:
            rows, rate, how = even_samples(time, rows, f"{arrays.path}, {name}")
            if stated is not None and abs(stated - rate) > SAME_RATE * rate:
                raise ImportProblem(
                    f"{arrays.path}: its sampling frequency is {stated:g} Hz, but the steps of"
                    f" {stamps} say {rate:g} Hz: correct the one that is wrong"
                )
            notes.append(how)
            start = float(time[0])
        for index, row in enumerate(rows):
            found.append(
                Signal(
                    name if len(rows) == 1 else f"{name}[{index}]",
                    str(arrays.path),
                    row,
                    rate,
                    arrays.units.get(name, ""),
                    arrays.unit_from if name in arrays.units else "",
                    note="; ".join(filter(None, notes)),
                    start=start,
                    lines=arrays.lines,
                    left_out=left_out,
                )
            )
    return found


def _of_other_length(arrays: Arrays, signals: dict[str, np.ndarray]) -> tuple[int, dict[str, str]]:
    """Return (samples of the longest signal, {name: why it is left out}). Raises ImportProblem."""
    if not signals:
        raise ImportProblem(
            f"{arrays.path}: holds no signal: no array of numbers but {', '.join(arrays.columns)}"
            if arrays.columns
            else f"{arrays.path}: holds no array of numbers: export the time histories"
        )
    samples = {name: rows.shape[-1] for name, rows in signals.items()}
    longest = max(samples.values())
    return longest, arrays.left_out | {
        name: f"has {count} samples, the longest signal {longest}"
        for name, count in samples.items()
        if count != longest
    }


def _stated_rate(arrays):
    """Return the sampling frequency in Hz that a file states, or None. Raises ImportProblem."""
    for known in (arrays.columns, arrays.attributes):
        for name in RATE_NAMES:
            if name not in known or np.size(known[name]) != 1:
                continue
            try:
                rate = float(np.squeeze(known[name]))
            except (TypeError, ValueError):
                rate = math.nan
            if not 0.0 < rate < math.inf:
                raise ImportProblem(
                    f"{arrays.path}: {name} = {str(known[name])[:40]} is no sampling frequency:"
                    " give it in Hz"
                )
            return rate
    return None


def _seconds(arrays, name):
    """Return (time,) the time stamps in s. Raises ImportProblem for an unknown unit."""
    unit = SINCE.sub("", arrays.units.get(name, "") or "s")
    try:
        return np.ravel(arrays.columns[name]).astype(float) * si_factor(unit, "time")
    except UnitError as error:
        raise ImportProblem(f"{arrays.path}, {name} {error}") from error


def _rows(values):
    """Return (signal, time) of an array: its longest axis last, all others flattened."""
    values = np.squeeze(np.asarray(values, float))
    if values.ndim == 0:
        return values.reshape(1, 1)
    values = np.moveaxis(values, int(np.argmax(values.shape)), -1)
    return values.reshape(-1, values.shape[-1])
