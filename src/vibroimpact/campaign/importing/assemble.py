"""A folder of measurements as a campaign.

The signals are found, their units and directions resolved, and the records aligned.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.units import UnitError, si_factor, si_unit

from .sidecar import DIRECTIONS, NAME, Record, Sensor, Sidecar, draft_sidecar, read_sidecar
from .signals import ImportProblem
from .tables import read_csv, read_matlab, read_netcdf
from .uff import read_uff

READERS = {
    ".uff": read_uff,
    ".unv": read_uff,
    ".uf": read_uff,
    ".ufb": read_uff,
    ".mat": read_matlab,
    ".csv": read_csv,
    ".nc": read_netcdf,
}


@dataclass(frozen=True)
class ResolvedSensor:
    """A sensor whose place, direction, kind and unit are known.

    channel: Channel.
    unit_from: where its unit stands.
    signals: its Signal in each record.
    role: "force" or "response".
    """

    channel: Channel
    unit_from: str
    signals: list
    role: str


def import_folder(folder: str | Path) -> tuple[xr.Dataset, list[dict]]:
    """Return (campaign Dataset, rows) of a folder with or without campaign.yaml.

    Each row is a sensor in a record: {record, sensor, role, kind, file, variable, unit_read,
    unit_from, unit_SI, factor, sampling_Hz, samples, duration_s, rms_SI, peak_SI, note}.
    Raises ImportProblem with every problem and its remedy.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise ImportProblem(
            f"{folder}: no such folder: give the folder that holds the measurements, --config"
            " import=FOLDER"
        )
    if (folder / NAME).is_file():
        sidecar = read_sidecar(folder / NAME)
        wanted = {name for record in sidecar.records for name in record.all_files()}
        found = _read_files(folder, wanted)
    else:
        found = _read_files(folder, None)
        sidecar = _sidecar_from_files(folder, found)
    problems: list[str] = []
    resolved = [
        _resolve_sensor(sensor, role, sidecar, folder, found, problems)
        for role, group in (("force", sidecar.forces), ("response", sidecar.channels))
        for sensor in group
    ]
    sensors = [sensor for sensor in resolved if sensor is not None]
    rate = _one_rate(sidecar, sensors, problems)
    voltage = _voltage(sidecar, folder, found, problems)
    if problems:
        raise ImportProblem("\n".join(dict.fromkeys(problems)))
    return _campaign(sidecar, sensors, rate, voltage), _rows(sidecar, sensors, rate)


def _read_files(folder, wanted):
    """Return {file name: [Signal]} of the measurements in the folder.

    wanted: names of the files to read; None for all.
    """
    files = sorted(
        file
        for file in folder.iterdir()
        if file.suffix.lower() in READERS
        and file.is_file()
        and (wanted is None or file.name in wanted)
    )
    if not files and wanted is not None:
        raise ImportProblem(
            f"{folder / NAME}: none of its files {', '.join(sorted(wanted))} is in the folder (read"
            f" are {', '.join(READERS)})"
        )
    if not files:
        raise ImportProblem(
            f"{folder}: holds no measurement: files ending in {', '.join(READERS)} are read"
        )
    found, problems = {}, []
    for file in files:
        try:
            found[file.name] = READERS[file.suffix.lower()](file)
        except ImportProblem as problem:
            problems.append(str(problem))
    if problems:
        raise ImportProblem("\n".join(problems))
    return found


def _sidecar_from_files(folder, found):
    """Return the Sidecar that universal files define by themselves: one record per file.

    Raises ImportProblem, with a draft of campaign.yaml, for other files.
    """
    signals = [signal for group in found.values() for signal in group]
    first = next(iter(found.values()))
    forces, responses = (
        [Sensor(name=signal.name) for signal in first if signal.force is wanted]
        for wanted in (True, False)
    )
    if not forces or not responses:
        missing = "force (ordinate type 13)" if not forces else "response"
        raise ImportProblem(
            f"{folder}: there is no {NAME} and the files do not say which signal is the {missing}:"
            f" put a {NAME} into the folder, such as\n\n{draft_sidecar(folder, signals)}"
        )
    return Sidecar(
        source=folder.name,
        forces=forces,
        channels=responses,
        records=[Record(name=Path(name).stem, file=name) for name in found],
    )


def _resolve_sensor(sensor, role, sidecar, folder, found, problems):
    """Return the ResolvedSensor, or None after adding to problems."""
    signals = [
        _signal_of(sensor.name, sensor.variable or sensor.name, record, folder, found, problems)
        for record in sidecar.records
    ]
    if any(signal is None for signal in signals):
        return None
    first = signals[0]
    place = f"{folder / NAME}, {sensor.name}"
    kind = sensor.kind or first.kind or ("generic" if role == "force" else "")
    if not kind:
        problems.append(
            f"{place}: the kind is not known: add kind: acceleration, velocity, displacement,"
            " contact_force or generic"
        )
    point = sensor.point_m or first.point
    direction = _unit_vector(sensor.direction, place, problems) or first.direction
    if point is None:
        problems.append(f"{place}: its place is not known: add point_m: [x, y, z] in metres")
    if direction is None:
        problems.append(
            f"{place}: its direction is not known: add direction: +x, -y, ... or [x, y, z], the"
            " positive sense"
        )
    units = {sensor.unit or signal.unit for signal in signals}
    unit = sensor.unit or first.unit
    if len(units) > 1:
        problems.append(
            f"{place}: its unit differs from record to record, {' and '.join(sorted(units))}:"
            " convert the files, or correct the labels with unit"
        )
    wanted = ("excitation" if role == "force" else kind) or "generic"
    try:
        si_factor(unit, wanted)
    except UnitError as error:
        problems.append(
            f"{place} {error}"
            + ("" if unit else f" (add unit to {NAME}; {Path(first.file).name} does not say it)")
        )
        return None
    if not kind or point is None or direction is None:
        return None
    unit_from = NAME if sensor.unit else first.unit_from
    if sensor.unit and first.unit and first.unit != unit:
        unit_from = f"{NAME}; {first.unit_from} says {first.unit}"
    channel = Channel(sensor.name, tuple(point), tuple(direction), unit, kind)
    return ResolvedSensor(channel, unit_from, signals, role)


def _unit_vector(direction, place, problems):
    """Return (3,) a direction of the sidecar as a unit vector, None where none is given."""
    if direction is None:
        return None
    vector = np.array(DIRECTIONS[direction] if isinstance(direction, str) else direction, float)
    length = np.linalg.norm(vector)
    if not length > 0.0:
        problems.append(f"{place}: direction is zero: give +x, -y, ... or [x, y, z]")
        return (1.0, 0.0, 0.0)
    return tuple((vector / length).tolist())


def _signal_of(sensor, variable, record, folder, found, problems):
    """Return the Signal of a sensor in a record; None after adding to problems."""
    wanted = record.variables.get(sensor, variable)
    known = []
    for name in record.all_files():
        if name not in found:
            problems.append(
                f"{folder / NAME}: record file '{name}' is not in the folder; it has"
                f" {', '.join(found)}"
            )
            return None
        known += found[name]
    matches = [signal for signal in known if signal.name == wanted] or [
        signal for signal in known if wanted in signal.aliases
    ]
    if len(matches) != 1:
        what = "is not" if not matches else f"is {len(matches)} times"
        problems.append(
            f"{folder / NAME}, {sensor}: the signal '{wanted}' {what} in"
            f" {', '.join(record.all_files())}: they have"
            f" {', '.join(signal.name for signal in known)}; name it with variable"
        )
        return None
    return matches[0]


def _cut(signal, record, rate):
    """Return (time,) the values of a record's signal between from_s and to_s."""
    first = 0 if record.from_s is None else int(round(record.from_s * rate))
    last = signal.values.size if record.to_s is None else int(round(record.to_s * rate))
    return signal.values[first:last]


def _one_rate(sidecar, sensors, problems):
    """Return the sampling frequency in Hz of all signals.

    Adds to problems where there is none or more than one.
    """
    rates = {signal.rate: signal for sensor in sensors for signal in sensor.signals if signal.rate}
    given = sidecar.sampling_frequency_Hz
    if given:
        problems += [
            f"{Path(signal.file).name}, {signal.name}: sampled at {rate:g} Hz, but"
            f" sampling_frequency_Hz of {NAME} = {given:g}: remove the key"
            for rate, signal in rates.items()
            if abs(rate - given) > 1e-6 * given
        ]
        return given
    if len(rates) > 1:
        listed = ", ".join(
            f"{rate:g} Hz ({Path(signal.file).name})" for rate, signal in sorted(rates.items())
        )
        problems.append(
            f"{NAME}: the signals are sampled at {listed}: resample them to one rate first"
        )
    if not rates and sensors:
        problems.append(f"{NAME}: no file states its sampling frequency: add sampling_frequency_Hz")
    return next(iter(rates), 1.0)


def _voltage(sidecar, folder, found, problems):
    """Return per record the voltage in V (time,), or None."""
    if sidecar.voltage is None:
        return None
    try:
        factor = si_factor(sidecar.voltage.unit, "voltage")
    except UnitError as error:
        problems.append(f"{folder / NAME}, voltage {error}")
        return None
    signals = [
        _signal_of("voltage", sidecar.voltage.variable, record, folder, found, problems)
        for record in sidecar.records
    ]
    if any(signal is None for signal in signals):
        return None
    return [replace(signal, values=factor * signal.values) for signal in signals]


def _campaign(sidecar, sensors, rate, voltage):
    """Return the campaign Dataset of the sensors.

    Shorter records are padded with NaN, and valid_samples gives their lengths.
    """
    groups = {
        role: [sensor for sensor in sensors if sensor.role == role]
        for role in ("force", "response")
    }
    cut = {
        role: [
            [_cut(sensor.signals[index], record, rate) for sensor in group]
            for index, record in enumerate(sidecar.records)
        ]
        for role, group in groups.items()
    }
    lengths = [
        min(values.size for role in cut for values in cut[role][index])
        for index in range(len(sidecar.records))
    ]
    longest = max(lengths)
    stacked = {
        role: np.array(
            [
                [_padded(values[:length], longest) for values in record]
                for record, length in zip(records, lengths, strict=True)
            ]
        )
        for role, records in cut.items()
    }
    loads = [
        np.sqrt(np.mean(np.square(record[0][:length])))
        for record, length in zip(cut["force"], lengths, strict=True)
    ]
    optional = {"valid_samples": np.array(lengths, np.int64)} if min(lengths) < longest else {}
    if voltage is not None:
        optional["voltage"] = np.array(
            [
                _padded(_cut(signal, record, rate)[:length], longest)
                for signal, record, length in zip(voltage, sidecar.records, lengths, strict=True)
            ]
        )
    gaps = [record.support_gap_m for record in sidecar.records]
    if all(gap is not None for gap in gaps):
        optional["support_gap"] = np.array(gaps, float)
    channels, drives = (
        [sensor.channel for sensor in groups[role]] for role in ("response", "force")
    )
    return campaign_dataset(
        stacked["force"],
        stacked["response"],
        channels,
        drives,
        _levels(sidecar, loads),
        rate,
        optional,
        source=sidecar.source,
        antialias=sidecar.antialias,
        start_up=sidecar.start_up,
        period_samples=sidecar.period_samples,
        transient_periods=sidecar.transient_periods,
    )


def _padded(values, length):
    return np.concatenate([values, np.full(length - values.size, np.nan)])


def _levels(sidecar, loads):
    """Return the Level of each record; repeats are counted where the sidecar does not give them."""
    levels, keys = [], []
    for record, load in zip(sidecar.records, loads, strict=True):
        gap = record.gap_m if record.gap_m is not None else np.nan
        key = (f"{load:.2g}", f"{gap:.4g}")
        name = record.name or Path(record.all_files()[0]).stem
        repeat = record.repeat if record.repeat is not None else keys.count(key)
        levels.append(Level(name, gap, repeat, record.split))
        keys.append(key)
    return levels


def _rows(sidecar, sensors, rate):
    """Return the rows of import_folder."""
    rows = []
    for index, record in enumerate(sidecar.records):
        for sensor in sensors:
            channel, signal = sensor.channel, sensor.signals[index]
            kind = "excitation" if sensor.role == "force" else channel.kind
            factor, values = si_factor(channel.units, kind), _cut(signal, record, rate)
            moving = values[np.isfinite(values)] * factor
            rows.append(
                {
                    "record": record.name or Path(record.all_files()[0]).stem,
                    "sensor": channel.name,
                    "role": sensor.role,
                    "kind": channel.kind,
                    "file": Path(signal.file).name,
                    "variable": signal.name,
                    "unit_read": channel.units,
                    "unit_from": sensor.unit_from,
                    "unit_SI": si_unit(channel.units, kind),
                    "factor": factor,
                    "sampling_Hz": rate,
                    "samples": values.size,
                    "duration_s": values.size / rate,
                    "rms_SI": float(np.sqrt(np.mean(moving**2))),
                    "peak_SI": float(np.abs(moving).max()),
                    "note": signal.note,
                }
            )
    return rows
