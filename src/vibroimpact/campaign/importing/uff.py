"""Time records of Universal File Format dataset 58, ASCII and binary, read with pyuff.

Nodes are taken from datasets 15 and 2411, units from 164.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from vibroimpact.io.signal_files.signals import ImportProblem, Signal, even_samples, whole_rate
from vibroimpact.io.units import SI_OF_KIND, UnitError, si_factor

TIME_RESPONSE, SHOCK = 1, 0  # function types that may hold time records
KIND_OF_TYPE = {
    8: "displacement",
    9: "contact_force",
    11: "velocity",
    12: "acceleration",
    13: "contact_force",
}
FORCE_TYPES = (13,)  # an excitation; a reaction is a response
MOTIONS = (8, 11, 12)  # they follow the unit of length, others that of force
AXES = {1: "x", 2: "y", 3: "z"}
NOTHING = ("", "NONE", "None", "none")
UNKNOWN, TIME = 0, 17
MARK = re.compile(rb"    -1(?= {74}|[\r\n]|\Z)")  # of the begin and the end of a dataset
ORDINATE_LINE, UNIT_LABEL = 10, slice(46, 66)  # of the unit of the ordinate, from the first mark
HEADER = 2000  # bytes, more than the header of a dataset 58 has
SHORTEST_STEP = 1e-9  # s
AGAIN = "export it again"


def read_uff(path: str | Path) -> list[Signal]:
    """Return the Signals of the time records of a file.

    A signal is named node:axis, as 12:+y; if a node has several, as a drive point has, with its
    quantity: "12:+y force". Its aliases are node:axis, the entity's name and the first
    identification line. Raises ImportProblem when the file can not be read or has no time record.
    """
    types, functions, nodes, units = read_functions(path)
    signals = [_signal(data, path, nodes, units) for data in functions if _is_time_record(data)]
    if not signals:
        found = sorted({f"{data['func_type']} ({data.get('id1', '')})" for data in functions})
        remedy = "export the time histories"
        if any(data["func_type"] == 4 for data in functions):
            remedy += f", or hold its frequency responses to a model: vibroimpact compare {path}"
        raise ImportProblem(
            f"{path}: holds no time record (dataset 58, function type 1); it has datasets"
            f" {sorted(set(types))}{', function types ' + ', '.join(found) if found else ''}:"
            f" {remedy}"
        )
    return _with_own_names(signals)


def _with_own_names(signals):
    """Return the Signals, each with a name of its own: node:axis, then its quantity, then its last
    alias, then a number, as far as it takes.
    """
    for level in range(3):
        names = [signal.name for signal in signals]
        details = [
            (
                "force" if signal.force else signal.kind.replace("_", " "),
                signal.aliases[-1] if len(signal.aliases) > 1 else "",
                f"#{names[: index + 1].count(signal.name)}",
            )[level]
            for index, signal in enumerate(signals)
        ]
        signals = [
            replace(signal, name=f"{signal.name} {detail}".rstrip())
            if names.count(signal.name) > 1
            else signal
            for signal, detail in zip(signals, details, strict=True)
        ]
    return signals


def read_functions(path: str | Path) -> tuple[list[int], list[dict], dict[int, tuple], dict | None]:
    """Return (number of each dataset, datasets 58, {node: (x, y, z) in m}, dataset 164 or None).

    Raises ImportProblem for a file that is damaged, for units that are none, and for nodes that are
    incomplete or at two places.
    """
    types, sets = _read_datasets(path)
    units = next((data for index, data in sets.items() if types[index] == 164), None)
    if units is not None and not all(0.0 < units[key] < np.inf for key in ("length", "force")):
        raise ImportProblem(
            f"{path}: dataset 164: {units['length']:g} and {units['force']:g} are no units of"
            f" length and force per SI unit: {AGAIN}"
        )
    tables = [data for index, data in sets.items() if types[index] in (15, 2411)]
    functions = [data for index, data in sets.items() if types[index] == 58]
    return types, functions, _nodes_of(tables, units, path), units


def _read_datasets(path):
    """Return (number of each dataset, {index: content} of those that are read).

    Raises ImportProblem for a file that is damaged: pyuff leaves out datasets that it can not name.
    """
    import pyuff  # imported here: other files do not need it

    try:
        file = pyuff.UFF(str(path))
        types = [int(number) for number in file.get_set_types()]
        sets = {
            index: file.read_sets(index)
            for index, number in enumerate(types)
            if number in (15, 58, 164, 2411)
        }
    except Exception as error:  # pyuff raises bare Exceptions
        raise ImportProblem(
            f"{path}: can not be read as a universal file ({error}): {AGAIN}"
        ) from error
    raw = Path(path).read_bytes()
    marks = [*MARK.finditer(raw)]
    if 0 in types or len(marks) % 2:
        what = f"dataset {types.index(0) + 1} has no number" if 0 in types else "one has no end"
        raise ImportProblem(
            f"{path}: {len(types)} datasets, of which {what}: the file is damaged or cut short,"
            f" {AGAIN}"
        )
    starts = [mark.start() for mark in marks[::2]]
    for index in (index for index, number in enumerate(types) if number == 58):
        sets[index] |= _label_of_unit(raw[starts[index] : starts[index] + HEADER])
    return types, sets


def _label_of_unit(header):
    """Return {key of pyuff: label} of a unit that is not written in UTF-8, whose letters pyuff
    drops; an empty dict for others.

    It is read as Windows-1252, in which µ and ² are the bytes that they are in Latin-1.
    """
    line = header.splitlines()[ORDINATE_LINE]
    try:
        line.decode("utf-8")
    except UnicodeDecodeError:
        return {"ordinate_axis_units_lab": line.decode("cp1252", "replace")[UNIT_LABEL].strip()}
    return {}


def _is_time_record(data):
    """Whether a function is real and its abscissa a time: of the type, or of an unknown type with
    the label of a time, or none.
    """
    abscissa = data.get("abscissa_spec_data_type", UNKNOWN)
    if data["func_type"] not in (SHOCK, TIME_RESPONSE) or np.iscomplexobj(data["data"]):
        return False
    try:
        return abscissa == TIME or (abscissa == UNKNOWN and _second(data, "") > 0.0)
    except ImportProblem:
        return False


def _signal(data, path, nodes, units):
    """Return the Signal of one dataset 58."""
    node, axis = int(data["rsp_node"]), int(data["rsp_dir"])
    name = node_name(node, axis)
    place = f"{path}, {name}"
    values, stated = np.asarray(data["data"], float), int(data["num_pts"])
    if not 1 < stated == values.size:
        raise ImportProblem(
            f"{place}: {values.size} of {stated} samples can be read: the file is damaged or cut"
            f" short, or its binary part was changed by a text transfer: {AGAIN}"
        )
    second = _second(data, place)
    if data["abscissa_spacing"] == 1:
        step, start = (data[key] * second for key in ("abscissa_inc", "abscissa_min"))
        if not SHORTEST_STEP < step < np.inf:
            raise ImportProblem(
                f"{place}: its time step is {step:g} s: correct the abscissa increment of dataset"
                " 58, or export it again"
            )
        rate, note = whole_rate(1.0 / step), ""
    else:
        time = np.asarray(data["x"], float) * second
        values, rate, note = even_samples(time, values, place)
        start = time[0]
    type_ = int(data["ordinate_spec_data_type"])
    unit, unit_from = unit_of(data, type_, units)
    direction = tuple(np.sign(axis) * np.eye(3)[abs(axis) - 1]) if abs(axis) in AXES else None
    aliases = tuple(
        text
        for text in (name, _text(data.get("rsp_ent_name")), _text(data.get("id1")))
        if text not in NOTHING
    )
    return Signal(
        name,
        str(path),
        values,
        rate,
        unit,
        unit_from,
        KIND_OF_TYPE.get(type_, ""),
        direction,
        nodes.get(node),
        type_ in FORCE_TYPES,
        aliases,
        note,
        start=float(start),
    )


def _second(data, place):
    """Return the unit of the abscissa in s: that of its label, else 1. Raises ImportProblem."""
    label = _text(data.get("abscissa_axis_units_lab"))
    if label in NOTHING:
        return 1.0
    try:
        return si_factor(label, "time")
    except UnitError as error:
        raise ImportProblem(f"{place}: its abscissa {error}") from error


def node_name(node: int, axis: int) -> str:
    """Return how a node and its direction, 1 to 3 or -3 to -1, are named: 12:+y."""
    text = f"{'+' if axis > 0 else '-'}{AXES[abs(axis)]}" if abs(axis) in AXES else str(axis)
    return f"{node}:{text}"


def _text(value):
    return str(value or "").strip()


def unit_of(data: dict, type_: int, units: dict | None) -> tuple[str, str]:
    """Return (unit as UDUNITS text, its place in the file); "" if the file does not state it.

    It is the axis label, else dataset 164 with the type of the ordinate.
    """
    label = _text(data.get("ordinate_axis_units_lab"))
    if label not in NOTHING:
        return label, "label of dataset 58"
    if units is None or type_ not in KIND_OF_TYPE:
        return "", ""
    # Dataset 164 holds file units per SI unit.
    factor = 1.0 / units["length" if type_ in MOTIONS else "force"]
    unit = SI_OF_KIND[KIND_OF_TYPE[type_]]
    return unit if abs(factor - 1.0) < 1e-9 else f"{factor:.12g} {unit}", "dataset 164"


def _nodes_of(tables, units, path):
    """Return {node: (x, y, z) in m} of datasets 15 and 2411.

    Empty without dataset 164, which gives their unit. Raises ImportProblem for incomplete nodes and
    for one that lies at two places.
    """
    if units is None:
        return {}
    nodes: dict[int, tuple] = {}
    for table in tables:
        columns = [np.asarray(table[key], float) for key in ("node_nums", "x", "y", "z")]
        if len({column.size for column in columns}) > 1 or not np.isfinite(columns).all():
            raise ImportProblem(f"{path}: the table of nodes is incomplete: {AGAIN}")
        for number, *place in zip(*columns, strict=True):
            point = tuple(float(value) / units["length"] for value in place)
            if nodes.setdefault(int(number), point) != point:
                raise ImportProblem(
                    f"{path}: node {int(number)} lies at {nodes[int(number)]} and at {point} m:"
                    " leave one of them"
                )
    return nodes
