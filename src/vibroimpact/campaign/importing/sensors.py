"""The sensors of a campaign: their signals in every record, and their place, direction and unit."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vibroimpact.campaign.file import Channel
from vibroimpact.campaign.force_kinds import BASE, FORCE
from vibroimpact.io.signal_files.signals import EVEN_WITHIN, WHOLE_WITHIN, Signal
from vibroimpact.io.units import UnitError, si_factor

from .raw_files import absence
from .sidecar import DIRECTIONS, NAME, Record, Sensor, Sidecar

NOWHERE = (np.nan, np.nan, np.nan)  # an acceleration of the base has no point


@dataclass(frozen=True)
class ResolvedSensor:
    """A sensor whose place, direction, kind and unit are known.

    channel: Channel.
    unit_from: the place of its unit.
    signals: its Signal in each record.
    role: "force" or "response".
    """

    channel: Channel
    unit_from: str
    signals: list[Signal]
    role: str

    @property
    def unit_kind(self) -> str:
        """Return the kind as si_factor knows it."""
        return _unit_kind(self.role, self.channel.kind)


def _unit_kind(role: str, kind: str) -> str:
    return "excitation" if role == "force" and kind != BASE else kind


@dataclass(frozen=True)
class Measured:
    """The sensors as described and as found; problems gathers the sentences on all faults.

    folder: of the measurements.
    sidecar: Sidecar.
    found: {file name: Signals}.
    """

    folder: Path
    sidecar: Sidecar
    found: dict[str, list[Signal]]
    problems: list[str]


def resolve_sensors(measured: Measured) -> list[ResolvedSensor]:
    """Return the ResolvedSensor of every force and channel that is described in full."""
    sidecar = measured.sidecar
    resolved = [
        _resolved(sensor, role, measured)
        for role, group in (("force", sidecar.forces), ("response", sidecar.channels))
        for sensor in group
    ]
    sensors = [sensor for sensor in resolved if sensor is not None]
    measured.problems.extend(dict.fromkeys(_shared_signals(sensors)))
    return sensors


def _resolved(sensor: Sensor, role: str, measured: Measured) -> ResolvedSensor | None:
    """Return the ResolvedSensor, or None after adding to problems."""
    problems = measured.problems
    signals = _signals_of(sensor.name, role, sensor.variable or sensor.name, measured)
    if signals is None:
        return None
    first = signals[0]
    place = f"{measured.folder / NAME}, {sensor.name}"
    kind = sensor.kind or first.kind
    if role == "force" and kind not in (BASE, "acceleration"):
        kind = FORCE
    if not kind:
        problems.append(
            f"{place}: the kind is not known: add kind: acceleration, velocity, displacement,"
            " contact_force, strain or generic"
        )
    if role == "force" and kind == "acceleration":
        problems.append(
            f"{place}: an acceleration is no force: add kind: {BASE} if all that holds the"
            " structure moves, else list it among channels"
        )
        return None
    point = sensor.point_m or first.point or (NOWHERE if kind == BASE else None)
    direction = _unit_vector(sensor.direction, place, problems) or first.direction
    if point is None:
        problems.append(f"{place}: its place is not known: add point_m: [x, y, z] in metres")
    if direction is None:
        problems.append(
            f"{place}: its direction is not known: add direction: +x, -y, ... or [x, y, z], the"
            " positive sense"
        )
    if getattr(sensor, "remove_offset", False):
        signals = [_without_offset(signal) for signal in signals]
    unit = _unit(sensor, signals, _unit_kind(role, kind), measured)
    if unit is None or not kind or point is None or direction is None:
        return None
    unit_from = NAME if sensor.unit else first.unit_from
    if sensor.unit and first.unit and first.unit != unit:
        unit_from = f"{NAME}; {first.unit_from} says {first.unit}"
    channel = Channel(sensor.name, tuple(point), tuple(direction), unit, kind)
    return ResolvedSensor(channel, unit_from, signals, role)


def _without_offset(signal: Signal) -> Signal:
    """Return the Signal less its median, and a note that says so."""
    offset = float(np.nanmedian(signal.values)) if np.isfinite(signal.values).any() else 0.0
    note = f"its offset of {offset:.4g} is taken out"
    return replace(
        signal, values=signal.values - offset, note="; ".join(filter(None, [signal.note, note]))
    )


def _unit(sensor: Sensor, signals: list[Signal], kind: str, measured: Measured) -> str | None:
    """Return the one unit of a sensor, None after adding to problems."""
    place, unit = f"{measured.folder / NAME}, {sensor.name}", sensor.unit or signals[0].unit
    units = {sensor.unit or signal.unit for signal in signals}
    if len(units) > 1:
        measured.problems.append(
            f"{place}: its unit differs from record to record, {' and '.join(sorted(units))}:"
            " convert the files, or correct the labels with unit"
        )
    try:
        si_factor(unit, kind or "generic")
    except UnitError as error:
        where = f" (add unit to {NAME}; {Path(signals[0].file).name} does not say it)"
        measured.problems.append(f"{place} {error}" + ("" if unit else where))
        return None
    return unit


def _unit_vector(direction, place, problems):
    """Return (3,) a direction of the sidecar as a unit vector, None if none is given."""
    if direction is None:
        return None
    vector = np.array(DIRECTIONS[direction] if isinstance(direction, str) else direction, float)
    length = np.linalg.norm(vector)
    if not length > 0.0:
        problems.append(f"{place}: direction is zero: give +x, -y, ... or [x, y, z]")
        return (1.0, 0.0, 0.0)
    return tuple((vector / length).tolist())


def _signals_of(sensor: str, role: str, variable: str, measured: Measured) -> list[Signal] | None:
    """Return the Signal of a sensor in each record; None after adding to problems."""
    signals = [
        _signal_of((sensor, role), record.variables.get(sensor, variable), record, measured)
        for record in measured.sidecar.records
    ]
    kept = [signal for signal in signals if signal is not None]
    return kept if len(kept) == len(signals) else None


def _signal_of(
    sensor: tuple[str, str], wanted: str, record: Record, measured: Measured
) -> Signal | None:
    """Return the Signal of a sensor, (name, role), in a record; None after adding to problems.

    Of several signals with this name, it is the one with that role in the file.
    """
    known: list[Signal] = []
    place = measured.folder / NAME
    for name in record.all_files():
        if name not in measured.found:
            measured.problems.append(
                f"{place}: record file '{name}' {absence(measured.folder / name)}; it has"
                f" {', '.join(measured.found)}"
            )
            return None
        known += measured.found[name]
    matches = [signal for signal in known if signal.name == wanted] or [
        signal for signal in known if wanted in signal.aliases
    ]
    of_role = [signal for signal in matches if signal.force == (sensor[1] == "force")]
    matches = of_role if len(of_role) == 1 else matches
    left_out = {name: why for signal in known for name, why in signal.left_out.items()}
    if not matches and wanted in left_out:
        measured.problems.append(
            f"{place}, {sensor[0]}: '{wanted}' of {', '.join(record.all_files())}"
            f" {left_out[wanted]}: give it as many real samples, or name another with variable"
        )
        return None
    if len(matches) != 1:
        what = "is not" if not matches else f"is {len(matches)} times"
        measured.problems.append(
            f"{place}, {sensor[0]}: the signal '{wanted}' {what} in"
            f" {', '.join(record.all_files())}: they have"
            f" {', '.join(signal.name for signal in known)}; name it with variable"
        )
        return None
    return matches[0]


def _shared_signals(sensors: list[ResolvedSensor]) -> Iterable[str]:
    """Yield a sentence for each signal that two sensors share."""
    for record in zip(*(sensor.signals for sensor in sensors), strict=True):
        taken: dict[tuple[str, str], str] = {}
        for sensor, signal in zip(sensors, record, strict=True):
            other = taken.setdefault((signal.file, signal.name), sensor.channel.name)
            if other != sensor.channel.name:
                yield (
                    f"{NAME}: {other} and {sensor.channel.name} are the same signal"
                    f" '{signal.name}' of {Path(signal.file).name}: name another with variable"
                )


def one_rate(sensors: list[ResolvedSensor], measured: Measured) -> float:
    """Return the sampling frequency in Hz of all signals: the one given, or of the longest signal.

    Rates are one to six digits, or as far as rounded times can say. Adds to problems if there is
    none or more than one.
    """
    signals = [signal for sensor in sensors for signal in sensor.signals]
    rates = {signal.rate: signal for signal in signals if signal.rate}
    given = measured.sidecar.sampling_frequency_Hz
    rate = given or max(rates, key=lambda each: rates[each].values.size, default=1.0)
    others = {
        found: signal
        for found, signal in rates.items()
        if abs(found / rate - 1.0) > max(WHOLE_WITHIN, EVEN_WITHIN / signal.values.size)
    }
    if given:
        measured.problems.extend(
            f"{Path(signal.file).name}, {signal.name}: sampled at {other:.9g} Hz, but"
            f" sampling_frequency_Hz of {NAME} = {given:.9g}: remove the key"
            for other, signal in others.items()
        )
    elif others:
        listed = ", ".join(
            f"{found:.9g} Hz ({Path(signal.file).name})" for found, signal in sorted(rates.items())
        )
        measured.problems.append(
            f"{NAME}: the signals are sampled at {listed}: resample them to one rate first"
        )
    elif not rates and sensors:
        measured.problems.append(
            f"{NAME}: no file states its sampling frequency: add sampling_frequency_Hz"
        )
    return rate


def read_voltage(measured: Measured) -> list[Signal] | None:
    """Return the Signal of the shaker's voltage in V in each record, None without."""
    wanted = measured.sidecar.voltage
    if wanted is None:
        return None
    try:
        factor = si_factor(wanted.unit, "voltage")
    except UnitError as error:
        measured.problems.append(f"{measured.folder / NAME}, voltage {error}")
        return None
    signals = _signals_of("voltage", "voltage", wanted.variable, measured)
    return signals and [replace(signal, values=factor * signal.values) for signal in signals]
