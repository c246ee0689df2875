"""The part of the signals that makes a record, and whether its values can be measured ones."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vibroimpact.io.signal_files.signals import EVEN_WITHIN, ImportProblem, Signal
from vibroimpact.io.units import si_factor

from .sensors import Measured, ResolvedSensor
from .sidecar import NAME, Record, record_names

# A measured value in SI units, and one as float32 can store it.
MOST_SI, MOST_STORED, LEAST_STORED = 1e12, 1e30, 1e-30


@dataclass(frozen=True)
class Cut:
    """A record: its name and the samples that it takes of each of its signals.

    start: s, when the last of its signals begins; None if no file has a time.
    rate: Hz.
    first, length: samples, from `start`.
    stated: whether to_s of the sidecar gives its end, not the signal that ends first.
    """

    name: str
    start: float | None
    rate: float
    first: int
    length: int
    stated: bool

    def late(self, signal: Signal) -> int:
        """Return how many samples of a signal are before the start of the record."""
        if self.start is None or signal.start is None:
            return 0
        return round((self.start - signal.start) * self.rate)

    def of(self, signal: Signal) -> np.ndarray:
        """Return (time,) the values of a signal in this record."""
        first = self.first + self.late(signal)
        return signal.values[first : first + self.length]


def cut_records(
    sensors: list[ResolvedSensor], voltage: list[Signal] | None, rate: float, measured: Measured
) -> list[Cut]:
    """Return the Cut of each record: of the time that all of its signals have.

    voltage: the Signal of the shaker's voltage in each record, or None.
    rate: Hz.

    Raises ImportProblem for signals that begin between two samples of another, for a cut that the
    record does not hold and for values that are not measurements.
    """
    records = measured.sidecar.records
    cuts: list[Cut] = []
    problems: list[str] = []
    for index, (record, name) in enumerate(zip(records, record_names(records), strict=True)):
        group = [sensor.signals[index] for sensor in sensors]
        group += [voltage[index]] if voltage else []
        start = max((signal.start for signal in group if signal.start is not None), default=None)
        first = round((record.from_s or 0.0) * rate)
        cut = Cut(name, start, rate, first, 0, record.to_s is not None)
        problems += _apart(group, cut)
        size = max(min(signal.values.size - cut.late(signal) for signal in group), 0)
        last = size if record.to_s is None else round(record.to_s * rate)
        problems += _outside(record, f"records[{index}]", size / rate, rate)
        cuts.append(replace(cut, length=max(min(last, size) - cut.first, 0)))
    problems += [] if problems else _short(cuts, measured)
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


def _apart(group: list[Signal], cut: Cut) -> Iterator[str]:
    """Yield a sentence for a signal that begins between the samples of the last one to begin, or
    ends before it.
    """
    last = max(group, key=lambda signal: -np.inf if signal.start is None else signal.start)
    for signal in group:
        if signal.start is None or cut.start is None:
            continue
        samples = (cut.start - signal.start) * cut.rate
        begin = (
            f"record {cut.name}: {signal.name} of {Path(signal.file).name} begins at"
            f" {signal.start:.9g} s, {last.name} of {Path(last.file).name} at {cut.start:.9g} s"
        )
        if samples >= signal.values.size:
            yield (
                f"{begin}, after its end: correct the time of the files, or leave it out and give"
                " sampling_frequency_Hz"
            )
        elif abs(samples - round(samples)) > EVEN_WITHIN:
            yield (
                f"{begin}, {samples:.2f} samples apart: export them from one clock, or resample"
                " them to common times"
            )


def _outside(record: Record, place: str, duration: float, rate: float) -> Iterator[str]:
    """Yield a sentence if from_s or to_s is beyond the end of the record."""
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

    NaN stands for a sample that is missing: the checks of the campaign name it.
    """
    values, unit = cut.of(signal), sensor.channel.units
    first = cut.first + cut.late(signal)
    size = np.abs(values)
    wrong = np.flatnonzero(size > min(MOST_STORED, MOST_SI / si_factor(unit, sensor.unit_kind)))
    if wrong.size:
        more = f" and {wrong.size - 1} others" if wrong.size > 1 else ""
        yield (
            f"{signal.place(first + int(wrong[0]))}: {values[wrong[0]]:g} {unit}{more} in"
            f" record {cut.name} is no measured value: correct the file or its unit, or write nan"
            " for a missing sample"
        )
    elif not np.isfinite(size).any() and sensor.role == "force":
        yield (
            f"{signal.place(first)}: {sensor.channel.name} has no value in record {cut.name}:"
            " leave the record out"
        )
    elif 0.0 < np.nanmax(size, initial=0.0) < LEAST_STORED:
        yield (
            f"{signal.place(first)}: {sensor.channel.name} is below {LEAST_STORED:g} {unit} in"
            f" record {cut.name}: correct its unit"
        )
