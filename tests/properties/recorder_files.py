"""Files of recorded signals as recorders and careless users write them, and what they then hold."""

from dataclasses import dataclass, field

import h5py
import netCDF4
import numpy as np
import scipy.io
from hypothesis import strategies as st

TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, None: 1.0}
RIGHT, EITHER, REFUSED = "right", "right or refused", "refused"


@dataclass
class Recording:
    """What a file was written from, and how far that can be read of it.

    signals {name: (time,)}: as stored, without noise of the type. rate: Hz.
    units {name: text}: as the file states them. factors {name: SI units per unit}.
    outcome: what a reader owes.
    relative: of the largest value, what the type of the numbers loses.
    odd: names of the habits that may be other than usual. habits: those that are, as (name, how).
    """

    signals: dict
    rate: float
    odd: tuple = ()
    units: dict = field(default_factory=dict)
    outcome: str = RIGHT
    relative: float = 1e-12
    habits: list = field(default_factory=list)
    factors: dict = field(default_factory=dict)

    def owes(self, outcome):
        """Lower what a reader owes: a refusal wins over either, and that over right."""
        order = (RIGHT, EITHER, REFUSED)
        self.outcome = max(self.outcome, outcome, key=order.index)


def _habit(draw, recording, name, values):
    """Draw how a recorder does something, the first of the values where it has no odd habit."""
    if name not in recording.odd:
        return values[0]
    chosen = draw(st.sampled_from(list(values[1:])))
    recording.habits.append((name, chosen))
    return chosen


TIMES = {
    "even": (lambda time, rate: time, RIGHT),
    "later": (lambda time, rate: time + 100.0, RIGHT),
    "rounded": (lambda time, rate: np.round(time, 6), RIGHT),
    "a step lost": (lambda time, rate: np.where(time > time[40], time + 5 / rate, time), REFUSED),
    "reversed": (lambda time, rate: time[::-1].copy(), REFUSED),
    "begins again": (lambda time, rate: np.where(time > time[60], time - time[60], time), REFUSED),
    "a sample is no number": (lambda time, rate: np.where(time == time[9], np.nan, time), REFUSED),
    "all zero": (lambda time, rate: 0.0 * time, REFUSED),
    "one stamp twice": (lambda time, rate: np.where(time == time[30], time[29], time), REFUSED),
    "counts samples": (lambda time, rate: np.arange(1.0, time.size + 1.0), EITHER),
}


def stamps(draw, recording):
    """(time (time,) in the unit of the file, its unit) of a recording."""
    unit = _habit(draw, recording, "unit of the time", [*TIME_UNITS])
    kind = _habit(draw, recording, "time", [*TIMES])
    even = np.arange(len(next(iter(recording.signals.values())))) / recording.rate
    change, outcome = TIMES[kind]
    recording.owes(outcome)
    time = change(even, recording.rate) / TIME_UNITS[unit]
    if kind == "counts samples":  # a time in steps: 1 Hz, in its unit
        recording.rate = 1.0 / TIME_UNITS[unit]
        time = change(even, 1.0)
    return time, unit


NUMBERS = {
    "f8": (lambda values: values, 1e-12),
    "f4": (lambda values: values.astype("f4"), 1e-6),
    ">f8": (lambda values: values.astype(">f8"), 1e-12),
    ">f4": (lambda values: values.astype(">f4"), 1e-6),
    "i4": (lambda values: np.round(1e6 * values).astype("i4"), 1e-6),
}


def _typed(draw, recording, kinds):
    """A function that turns values into the type of the file."""
    kind = _habit(draw, recording, "type", kinds)
    change, loss = NUMBERS[kind]
    recording.relative = max(recording.relative, loss)
    if kind == "i4":  # whole numbers that the file does not scale back
        recording.signals = {name: 1e6 * each for name, each in recording.signals.items()}
        return lambda values: np.round(values).astype("i4")
    return change


# {quantity: {unit: SI units per unit}}, 0 of one of another quantity; the first is usual.
UNITS = {
    "force": {"N": 1.0, "kN": 1e3, "lbf": 4.4482216152605, "mN": 1e-3, "kgf": 9.80665, "N ": 1.0,
              "Newton": 1.0, "kg": 0.0, "V": 0.0, "m/s^2": 0.0, "dB": 0.0},
    "acceleration": {"m/s^2": 1.0, "g": 9.80665, "mm/s^2": 1e-3, "m s-2": 1.0, "mg": 9.80665e-3,
                     "m/s²": 1.0, "ft/s^2": 0.3048, "G": 9.80665, "m/s": 0.0, "V": 0.0, "kg": 0.0},
}  # fmt: skip


def stated_units(draw, recording, quantities):
    """Let a recording state the units of its signals; quantities {name: quantity}."""
    for name, quantity in quantities.items():
        unit = _habit(draw, recording, "unit", [*UNITS[quantity]])
        recording.units[name], recording.factors[name] = unit, UNITS[quantity][unit]
        recording.owes(RIGHT if recording.factors[name] else REFUSED)


STATED = (None, "Fs", "sampling_frequency", "sampling_frequency_Hz", "fs")
RATES = {
    "as it is": (lambda rate: rate, RIGHT),
    "in kHz": (lambda rate: rate / 1000.0, RIGHT),
    "half": (lambda rate: rate / 2.0, RIGHT),
    "the step": (lambda rate: 1.0 / rate, RIGHT),
    "negative": (lambda rate: -rate, REFUSED),
    "not a number": (lambda rate: np.nan, REFUSED),
    "whole": (lambda rate: np.int32(round(rate)), RIGHT),
    "a text": (lambda rate: f"{rate:g} Hz", EITHER),
}


def stated_rate(draw, recording):
    """(name, value) of the sampling frequency that a file with a time states, (None, None)."""
    name = _habit(draw, recording, "name of the rate", STATED)
    if name is None and "rate" not in recording.odd:
        return None, None
    name, kind = name or "Fs", _habit(draw, recording, "rate", [*RATES])
    change, outcome = RATES[kind]
    recording.owes(outcome)
    return name, change(recording.rate)


def _hold_to_time(recording, rate):
    """Demand a refusal where the stated rate, None for none, is not that of the time."""
    if rate is not None and not isinstance(rate, str) and rate != recording.rate:
        recording.owes(REFUSED)


CSV_NUMBERS = {
    "repr": (lambda value: repr(float(value)), 1e-12, RIGHT),
    "%.9e": (lambda value: f"{value:.9e}", 1e-9, RIGHT),
    "%+.8E": (lambda value: f"{value:+.8E}", 1e-7, RIGHT),
    "decimal comma": (lambda value: f"{value:.12f}".replace(".", ","), 1e-11, EITHER),
    "Fortran": (lambda value: f"{value:.9e}".replace("e", "D"), 1e-9, REFUSED),
    "with unit": (lambda value: f"{value:.9e} N", 1e-9, REFUSED),
    "thousands": (lambda value: f"{1e6 * value:,.9f}", 1e-9, REFUSED),
    "quoted": (lambda value: f'"{value:.9e}"', 1e-9, EITHER),
}
CELLS = ("", "NaN", "n/a", "-", "#DIV/0!", "1.#QNAN", "OVERLOAD")
LINES = ("\n", "\r\n", "\r")
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "cp1252")


def write_csv(draw, path, recording):
    """Write a table; return nothing: `recording` then says what it holds."""
    time, unit = stamps(draw, recording)
    kind = _habit(draw, recording, "numbers", [*CSV_NUMBERS])
    text, loss, outcome = CSV_NUMBERS[kind]
    recording.relative = max(recording.relative, 10 * loss)
    recording.owes(outcome)
    mark = _habit(draw, recording, "separator", [",", ";", "\t", " ", " ; "])
    if kind == "decimal comma" and mark not in (";", "\t", " ; "):
        recording.owes(REFUSED if mark == "," else EITHER)
    if kind in ("with unit", "thousands") and mark in (" ", ","):
        recording.owes(REFUSED)
    names = {"time": unit, **{name: recording.units.get(name) for name in recording.signals}}
    style = _habit(draw, recording, "names", ["[unit]", "(unit)", "comment", "none", "twice"])
    if style == "none":
        recording.owes(REFUSED)
    form = "{} ({})" if style == "(unit)" else "{} [{}]"
    if mark == " ":
        form = form.replace(" ", "")
    header = [form.format(name, each) if each else name for name, each in names.items()]
    if style == "twice":
        header[-1] = header[-2]
        recording.owes(REFUSED)
    if mark == " " and any(" " in unit for unit in recording.units.values()):
        recording.owes(EITHER)
    rows = [
        [text(value) for value in row]
        for row in zip(time, *recording.signals.values(), strict=True)
    ]
    for cells, value in zip(rows, time, strict=True):
        cells[0] = text(value) if np.isfinite(value) else "nan"
    cell = _habit(draw, recording, "a cell", [None, *CELLS])
    if cell is not None:
        rows[5][1] = cell
        recording.signals[next(iter(recording.signals))][5] = np.nan
        recording.owes(EITHER if cell == "NaN" else REFUSED)
    above = _habit(draw, recording, "above the table", ["", "# rig 7, Tuesday\n", "Rig 7\n\n"])
    recording.owes(REFUSED if above.startswith("Rig") else RIGHT)
    lead = {"comment": "# ", "none": None}.get(style, "")
    table = [] if lead is None else [lead + mark.join(header)]
    end = _habit(draw, recording, "end of a line", ["", mark.strip() or " "])
    table += [mark.join(row) for row in rows]
    whole = above + "\n".join(line + (end if line[:1] != "#" else "") for line in table) + "\n"
    newline = _habit(draw, recording, "lines", LINES)
    encoding = _habit(draw, recording, "encoding", ENCODINGS)
    path.write_bytes(whole.replace("\n", newline).encode(encoding))
    recording.owes(EITHER if above or end or style == "comment" else RIGHT)


def write_mat(draw, path, recording):
    """Write a MATLAB file of version 4, 5 or 7.3."""
    version = _habit(draw, recording, "version", ["5", "4", "7.3"])
    if version == "4":
        recording.odd = tuple(each for each in recording.odd if each not in ("shape", "also"))
    kinds = ["f8", "f4", "i4"] if version != "7.3" else ["f8", "f4", "i4", ">f8", ">f4"]
    typed = _typed(draw, recording, kinds)
    name, rate = stated_rate(draw, recording)
    time, unit = stamps(draw, recording)
    recording.rate *= TIME_UNITS[unit]  # no unit is stated, a rate shows that one is meant
    _hold_to_time(recording, rate)
    shape = _habit(draw, recording, "shape", ["column", "row", "cube"])
    axes = {"column": (-1, 1), "row": (1, -1), "cube": (1, -1, 1)}[shape]
    found = {key: typed(values).reshape(axes) for key, values in recording.signals.items()}
    found = {"time": time.reshape(axes), **found}
    if name is not None:
        found[name] = rate
    extra = _habit(draw, recording, "also", ["nothing", "a text", "a complex array", "a cell"])
    more = {"a text": "rig 7", "a complex array": np.ones(9) * 1j, "nothing": None}.get(extra)
    if extra == "a cell":
        more = np.array(["a", 1], dtype=object)
    if version == "7.3":
        with h5py.File(path, "w", userblock_size=512) as file:
            for key, values in found.items():
                file[key] = values if isinstance(values, str) else np.asarray(values).T
        return
    if more is not None:
        found["more"] = more
    packed = version == "5" and _habit(draw, recording, "compressed", [False, True])
    scipy.io.savemat(path, found, format=version, do_compression=packed)


def write_netcdf(draw, path, recording):
    """Write a netCDF file of one of its forms."""
    form = _habit(draw, recording, "form", ["NETCDF4", "NETCDF3_CLASSIC", "NETCDF4_CLASSIC"])
    name, rate = stated_rate(draw, recording)
    time, unit = stamps(draw, recording)
    _hold_to_time(recording, rate)
    kind = _habit(draw, recording, "type", ["f8", "f4", "i4", "packed", "big"])
    dtype, order = {"packed": "i2", "big": "f8"}.get(kind, kind), "native"
    if kind == "big" and form != "NETCDF3_CLASSIC":  # which is in this order by itself
        dtype, order = ">f8", "big"
    recording.relative = {"f4": 1e-6, "packed": 2e-4}.get(kind, 1e-12)
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.createDimension("time", time.size)
        stored = file.createVariable("time", "f8", ("time",))
        stored[:] = time
        if unit is not None:
            stored.units = unit
        for key, values in recording.signals.items():
            variable = file.createVariable(key, dtype, ("time",), endian=order)
            if kind == "packed":
                variable.scale_factor = np.abs(values).max() / 3e4
                variable.add_offset = 0.0
            if kind == "i4":
                recording.signals[key] = values = np.round(values)
            variable[:] = values
            if recording.units.get(key):
                variable.units = recording.units[key]
        if name is not None:
            file.setncattr(name, rate)


WRITERS = {".csv": write_csv, ".mat": write_mat, ".nc": write_netcdf}
TABLE = ("numbers", "separator", "names", "a cell", "above the table", "end of a line", "lines")
SAMPLING = ("time", "unit of the time")
RATE = ("rate", "name of the rate")
HABITS = {
    ".csv": (*SAMPLING, *TABLE, "encoding", "unit"),
    ".mat": (*SAMPLING, *RATE, "version", "type", "shape", "also", "compressed"),
    ".nc": (*SAMPLING, *RATE, "form", "type", "unit"),
}


def odd_habits(draw, ending):
    """Names of up to three habits of the files of a kind."""
    return tuple(draw(st.lists(st.sampled_from(HABITS[ending]), max_size=3, unique=True)))
