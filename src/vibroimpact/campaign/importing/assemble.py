"""A folder of measurements as a campaign: its Dataset, and a row per sensor and record."""

from pathlib import Path

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import (
    DEFAULTS,
    Level,
    campaign_dataset,
    contract_problems,
    load_of,
    with_no_force,
)
from vibroimpact.io.signal_files.signals import ImportProblem
from vibroimpact.io.units import si_factor, si_unit

from .cuts import cut_records
from .raw_files import raw_files, read_signals
from .sensors import Measured, one_rate, read_voltage, resolve_sensors
from .sidecar import NAME, Drive, Record, Sensor, Sidecar, read_sidecar


def import_folder(folder: str | Path) -> tuple[xr.Dataset, list[dict]]:
    """Return (campaign Dataset, rows) of a folder with or without campaign.yaml.

    Each row is a sensor in a record: {record, sensor, role, kind, file, variable, unit_read,
    unit_from, unit_SI, factor, sampling_Hz, samples, duration_s, rms_SI, peak_SI, note}.
    Raises ImportProblem with every problem and its remedy. Only files in the folder are read.
    """
    folder = Path(folder)
    files = raw_files(folder)
    described = files[0].name == NAME
    found = read_signals(files[described:])
    sidecar = read_sidecar(files[0]) if described else _sidecar_from_files(folder, found)
    measured = Measured(folder, sidecar, found, [])
    sensors = resolve_sensors(measured)
    rate = one_rate(sensors, measured)
    voltage = read_voltage(measured)
    if measured.problems:
        raise ImportProblem("\n".join(dict.fromkeys(measured.problems)))
    cuts = cut_records(sensors, voltage, rate, measured)
    campaign = _campaign(sidecar, sensors, cuts, rate, voltage)
    problems = contract_problems(with_no_force(campaign), force_needed=bool(sidecar.forces))
    breaches = [f"{folder / NAME}: the campaign {line}" for line in problems]
    if breaches:
        raise ImportProblem("\n".join(breaches))
    return campaign, [
        _row(sensor, sensor.signals[index], cut, rate)
        for index, cut in enumerate(cuts)
        for sensor in sensors
    ]


def _sidecar_from_files(folder, found):
    """Return the Sidecar that universal files define by themselves: one record per file.

    Raises ImportProblem for other files.
    """
    first = next(iter(found.values()))
    forces = [Drive(name=signal.name) for signal in first if signal.force]
    responses = [Sensor(name=signal.name) for signal in first if not signal.force]
    if not forces or not responses:
        missing = "force (ordinate type 13)" if not forces else "response"
        raise ImportProblem(
            f"{folder}: there is no {NAME}, and the files do not say which signal is the {missing}:"
            f" put a {NAME} into the folder"
        )
    return Sidecar(
        source=folder.name if folder.name.isprintable() else "",
        forces=forces,
        channels=responses,
        records=[Record(file=name) for name in found],
    )


def _campaign(sidecar, sensors, cuts, rate, voltage):
    """Return the campaign Dataset of the sensors.

    Shorter records are padded with NaN, and valid_samples gives their lengths.
    """
    lengths = [cut.length for cut in cuts]

    def padded(cut, signal):
        values = cut.of(signal)
        return np.concatenate([values, np.full(max(lengths) - values.size, np.nan)])

    groups, stacked = {}, {}
    for role in ("force", "response"):
        groups[role] = [sensor for sensor in sensors if sensor.role == role]
        stacked[role] = np.array(
            [
                [padded(cut, sensor.signals[index]) for sensor in groups[role]]
                for index, cut in enumerate(cuts)
            ]
        )
    optional = {"valid_samples": np.array(lengths, np.int64)} if len({*lengths}) > 1 else {}
    if voltage is not None:
        optional["voltage"] = np.array(list(map(padded, cuts, voltage)))
    if sidecar.records[0].support_gap_m is not None:
        optional["support_gap"] = np.array(
            [record.support_gap_m for record in sidecar.records], float
        )
    channels, drives = (
        [sensor.channel for sensor in groups[role]] for role in ("response", "force")
    )
    stated = {key: getattr(sidecar, key) for key in DEFAULTS}
    stated |= {} if sidecar.band_Hz is None else {"band_Hz": sidecar.band_Hz}
    loads = [np.nan] * len(cuts)
    if drives:
        loads = [load_of(force[0], rate, sidecar.band_Hz) for force in stacked["force"]]
    return campaign_dataset(
        stacked["force"],
        stacked["response"],
        channels,
        drives,
        _levels(sidecar, cuts, loads),
        rate,
        optional,
        **stated,
    )


def _levels(sidecar, cuts, loads):
    """Return the Level of each record; repeats are counted if the sidecar does not give them."""
    levels, keys = [], []
    for record, cut, load in zip(sidecar.records, cuts, loads, strict=True):
        gap = record.gap_m if record.gap_m is not None else np.nan
        key = (f"{load:.2g}", f"{gap:.4g}")
        repeat = record.repeat if record.repeat is not None else keys.count(key)
        levels.append(Level(cut.name, gap, repeat, record.split))
        keys.append(key)
    return levels


def _row(sensor, signal, cut, rate):
    channel = sensor.channel
    factor, values = si_factor(channel.units, sensor.unit_kind), cut.of(signal)
    moving = values[np.isfinite(values)] * factor
    return {
        "record": cut.name,
        "sensor": channel.name,
        "role": sensor.role,
        "kind": channel.kind,
        "file": Path(signal.file).name,
        "variable": signal.name,
        "unit_read": channel.units,
        "unit_from": sensor.unit_from,
        "unit_SI": si_unit(channel.units, sensor.unit_kind),
        "factor": factor,
        "sampling_Hz": rate,
        "samples": values.size,
        "duration_s": values.size / rate,
        "rms_SI": float(np.sqrt(np.mean(moving**2))) if moving.size else np.nan,
        "peak_SI": float(np.abs(moving).max()) if moving.size else np.nan,
        "note": "; ".join(filter(None, [signal.note, *_losses(signal, cut, moving.size)])),
    }


def _losses(signal, cut, finite):
    """Yield a sentence on the samples of a signal that are missing or left out in a record."""
    if finite < cut.length:
        yield f"{cut.length - finite} of {cut.length} samples are missing (nan)"
    late = cut.late(signal)
    if late:
        yield f"its first {late} samples are left out: another signal of the record begins later"
    longer = signal.values.size - late - cut.first - cut.length
    if longer > 0 and not cut.stated:
        yield f"its last {longer} samples are left out: another signal of the record ends there"
