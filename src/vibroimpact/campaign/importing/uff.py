"""Time records of Universal File Format dataset 58, ASCII and binary, read with pyuff.

Nodes are taken from datasets 15 and 2411, units from 164.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .signals import ImportProblem, Signal, even_samples, whole_rate

TIME_RESPONSE, SHOCK = 1, 0  # function types that may hold time records
KIND_OF_TYPE = {
    8: "displacement",
    9: "contact_force",
    11: "velocity",
    12: "acceleration",
    13: "contact_force",
}
FORCE_TYPES = (13,)  # an excitation; a reaction is a response
SI_OF_TYPE = {8: "m", 9: "N", 11: "m s-1", 12: "m s-2", 13: "N"}
LENGTH_POWER = {8: 1, 11: 1, 12: 1}  # of the length unit; forces follow the force unit
AXES = {1: "x", 2: "y", 3: "z"}
NOTHING = ("", "NONE", "None", "none")
TIME_TYPES = (0, 17)


def read_uff(path: str | Path) -> list[Signal]:
    """Return the Signals of the time records of a file.

    A signal is named node:axis, as 12:+y. Its aliases are the entity's name and the first
    identification line. Raises ImportProblem when the file can not be read or has no time record.
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
        raise ImportProblem(f"{path}: can not be read as a universal file ({error})") from error
    units = next((data for index, data in sets.items() if types[index] == 164), None)
    nodes = _nodes([data for index, data in sets.items() if types[index] in (15, 2411)], units)
    functions = [data for index, data in sets.items() if types[index] == 58]
    signals = [_signal(data, path, nodes, units) for data in functions if _is_time_record(data)]
    if not signals:
        found = sorted({f"{data['func_type']} ({data.get('id1', '')})" for data in functions})
        raise ImportProblem(
            f"{path}: holds no time record (dataset 58, function type 1); it has datasets"
            f" {sorted(set(types))}{', function types ' + ', '.join(found) if found else ''}:"
            " export the time histories"
        )
    return signals


def _is_time_record(data):
    return (
        data["func_type"] in (SHOCK, TIME_RESPONSE)
        and data.get("abscissa_spec_data_type", 0) in TIME_TYPES
        and not np.iscomplexobj(data["data"])
    )


def _signal(data, path, nodes, units):
    """Return the Signal of one dataset 58."""
    node, axis = int(data["rsp_node"]), int(data["rsp_dir"])
    name = f"{node}:{_axis_text(axis)}"
    place = f"{path}, {name}"
    values, stated = np.asarray(data["data"], float), int(data["num_pts"])
    if values.size < stated:
        raise ImportProblem(
            f"{place}: {values.size} of {stated} samples can be read: the file is cut short, or its"
            " binary part was changed by a text transfer"
        )
    values = values[:stated]
    if data["abscissa_spacing"] == 1:
        rate = whole_rate(1.0 / data["abscissa_inc"]) if data["abscissa_inc"] > 0.0 else None
        note = ""
    else:
        values, rate, note = even_samples(np.asarray(data["x"], float)[:stated], values, place)
    type_ = int(data["ordinate_spec_data_type"])
    unit, unit_from = _unit(data, type_, units)
    direction = tuple(np.sign(axis) * np.eye(3)[abs(axis) - 1]) if abs(axis) in AXES else None
    aliases = tuple(
        text
        for text in (_text(data.get("rsp_ent_name")), _text(data.get("id1")))
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
    )


def _axis_text(axis):
    return f"{'+' if axis > 0 else '-'}{AXES[abs(axis)]}" if abs(axis) in AXES else str(axis)


def _text(value):
    return str(value or "").strip()


def _unit(data, type_, units):
    """Return (unit as UDUNITS text, where it is stated); "" where the file does not state it.

    It is the axis label, else dataset 164 with the type of the ordinate.
    """
    label = _text(data.get("ordinate_axis_units_lab"))
    if label not in NOTHING and "\ufffd" not in label:
        return label, "label of dataset 58"
    if units is None or type_ not in SI_OF_TYPE:
        return "", ""
    # Dataset 164 holds file units per SI unit.
    factor = 1.0 / (
        units["length"] ** LENGTH_POWER[type_] if type_ in LENGTH_POWER else units["force"]
    )
    unit = SI_OF_TYPE[type_]
    return unit if abs(factor - 1.0) < 1e-9 else f"{factor:.12g} {unit}", "dataset 164"


def _nodes(tables, units):
    """Return {node: (x, y, z) in m} of datasets 15 and 2411.

    Empty without dataset 164, which gives their unit.
    """
    if units is None:
        return {}
    return {
        int(node): tuple(float(value) / units["length"] for value in place)
        for table in tables
        for node, *place in zip(table["node_nums"], table["x"], table["y"], table["z"], strict=True)
    }
