"""The part of the signals that makes a record, and whether its values can be measured ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vibroimpact.units import si_factor

from .sensors import Measured, ResolvedSensor
from .sidecar import NAME, Record, record_names
from .signals import ImportProblem, Signal

# A measured value in SI units, and one as float32 can store it.
MOST_SI, MOST_STORED, LEAST_STORED = 1e12, 1e30, 1e-30


@dataclass(frozen=True)
class Cut:
    """A record: its name and the samples that it takes of each of its signals.

    first, length: samples, from 0.
    stated: whether to_s of the sidecar gives its end, not the shortest signal.
    """

    name: str
    first: int
    length: int
    stated: bool

    def of(self, signal: Signal) -> np.ndarray:
        """Return (time,) the values of a signal in this record."""
        return signal.values[self.first : self.first + self.length]


def cut_records(sensors: list[ResolvedSensor], rate: float, measured: Measured) -> list[Cut]:
    """Return the Cut of each record; it ends with the shortest of its signals.

    rate: Hz.

    Raises ImportProblem for a cut that the record does not hold and for values that are no
    measurement.
    """
    records = measured.sidecar.records
    cuts: list[Cut] = []
    problems: list[str] = []
    for index, (record, name) in enumerate(zip(records, record_names(records), strict=True)):
        size = min(sensor.signals[index].values.size for sensor in sensors)
        first = round((record.from_s or 0.0) * rate)
        last = size if record.to_s is None else round(record.to_s * rate)
        problems += _outside(record, f"records[{index}]", size / rate, rate)
        length = max(min(last, size) - first, 0)
        cuts.append(Cut(name, first, length, record.to_s is not None))
    problems += _short(cuts, measured)
    if not problems:
        problems = [
            problem
            for index, cut in enumerate(cuts)
            for sensor in sensors
            for problem in _odd_values(sensor, sensor.signals[index], cut)
        ]
    if problems:
        raise ImportProblem("\n".join(f"{measured.folder / NAME}: {line}" for line in problems))
    return cuts


def _outside(record: Record, place: str, duration: float, rate: float) -> Iterator[str]:
    """Yield a sentence where from_s or to_s is beyond the end of the record."""
    for key, time in (("from_s", record.from_s), ("to_s", record.to_s)):
        if time is not None and time > duration + 0.5 / rate:
            yield (
                f"{place}.{key} = {time:g} is beyond the end of {', '.join(record.all_files())},"
                f" {duration:.6g} s: give a time within it, or leave {key} out"
            )


def _short(cuts: list[Cut], measured: Measured) -> Iterator[str]:
    """Yield a sentence for each record with too few samples."""
    sidecar = measured.sidecar
    needed = max(2, sidecar.period_samples * (1 + sidecar.transient_periods))
    for index, cut in enumerate(cuts):
        if cut.length < needed:
            what = "one period after the transient" if sidecar.period_samples else "a record"
            yield (
                f"records[{index}] has {cut.length} samples, {what} takes {needed}: correct"
                f" {'period_samples, transient_periods, ' if sidecar.period_samples else ''}from_s"
                " or to_s"
            )


def _odd_values(sensor: ResolvedSensor, signal: Signal, cut: Cut) -> Iterator[str]:
    """Yield a sentence for the first value of a signal that no sensor measures.

    NaN stands for a sample that is missing: the checks of the campaign say what is left out.
    """
    values, unit = cut.of(signal), sensor.channel.units
    size = np.abs(values)
    wrong = np.flatnonzero(size > min(MOST_STORED, MOST_SI / si_factor(unit, sensor.unit_kind)))
    if wrong.size:
        more = f" and {wrong.size - 1} others" if wrong.size > 1 else ""
        yield (
            f"{signal.place(cut.first + int(wrong[0]))}: {values[wrong[0]]:g} {unit}{more} in"
            f" record {cut.name} is no measured value: correct the file or its unit, or write nan"
            " where a sample is missing"
        )
    elif not np.isfinite(size).any() and sensor.role == "force":
        yield (
            f"{signal.place(cut.first)}: {sensor.channel.name} has no value in record {cut.name}:"
            " leave the record out"
        )
    elif 0.0 < np.nanmax(size, initial=0.0) < LEAST_STORED:
        yield (
            f"{signal.place(cut.first)}: {sensor.channel.name} is below {LEAST_STORED:g} {unit} in"
            f" record {cut.name}: correct its unit"
        )
