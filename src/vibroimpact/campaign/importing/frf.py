"""Frequency response functions of Universal File Format dataset 58, function type 4."""

from pathlib import Path

import numpy as np

from vibroimpact.campaign.file import Channel
from vibroimpact.campaign.force_kinds import FORCE
from vibroimpact.io.signal_files.signals import ImportProblem
from vibroimpact.io.units import TIME_DERIVATIVES, UnitError, si_factor

from .uff import FORCE_TYPES, KIND_OF_TYPE, node_name, read_functions, unit_of

FRF = 4  # function type


def read_frfs(path: str | Path) -> tuple[np.ndarray, np.ndarray, list[Channel], Channel]:
    """Return (frequency (line,) in Hz above 0, complex responses (channel, line) in SI per N, the
    Channel of each response, that of the one force) of a universal file.

    Of a hammer that roved while one accelerometer stayed, response and force change places: a
    linear structure responds alike (J. C. Maxwell 1864). Raises ImportProblem for a file without
    frequency responses of one force or one response, and for one without their places.
    """
    _, functions, nodes, units = read_functions(path)
    functions = [data for data in functions if data["func_type"] == FRF]
    if not functions:
        raise ImportProblem(f"{path}: holds no frequency response (dataset 58, function type 4)")
    moving, fixed = _ends(functions, path)
    kinds = [_kind(data, path) for data in functions]
    channels = [
        _channel(node, axis, kind, nodes, path)
        for (node, axis), kind in zip(moving, kinds, strict=True)
    ]
    drive = _channel(fixed[0], fixed[1], FORCE, nodes, path)
    names = [channel.name for channel in channels]
    if len({*names}) < len(names):
        raise ImportProblem(f"{path}: {', '.join(names)}: leave one frequency response of each")
    lines = [_lines(data, kind, units, path) for data, kind in zip(functions, kinds, strict=True)]
    frequency = lines[0][0]
    if any(each[0].shape != frequency.shape or np.ptp(each[0] - frequency) for each in lines):
        raise ImportProblem(f"{path}: the frequency responses have different lines: export again")
    h1 = np.array([each[1] for each in lines])
    kept = (frequency > 0.0) & np.isfinite(h1).all(axis=0)
    return frequency[kept], h1[:, kept], channels, drive


def _ends(functions, path):
    """Return ((node, axis) of each channel, that of the force): of the responses, or of the forces
    if those moved.
    """
    responses, forces = (
        [(int(data[f"{end}_node"]), int(data[f"{end}_dir"])) for data in functions]
        for end in ("rsp", "ref")
    )
    if len({*forces}) > 1 and len({*responses}) > 1:
        raise ImportProblem(
            f"{path}: has {len({*forces})} forces and {len({*responses})} responses: write the"
            " responses to one force, or those at one place, to a file"
        )
    return (forces, responses[0]) if len({*forces}) > 1 else (responses, forces[0])


def _kind(data, path):
    """Return the kind of a response per force."""
    numerator, denominator = (
        int(data[f"{part}_spec_data_type"]) for part in ("ordinate", "orddenom")
    )
    kind = KIND_OF_TYPE.get(numerator, "")
    if kind not in TIME_DERIVATIVES or denominator not in (0, *FORCE_TYPES):
        raise ImportProblem(
            f"{path}: ordinate types {numerator} over {denominator}: displacements (8), velocities"
            " (11) and accelerations (12) over a force (13) are compared"
        )
    return kind


def _channel(node, axis, kind, nodes, path):
    """Return the Channel at a node along an axis, 1 to 3 or -3 to -1."""
    if node not in nodes or abs(axis) not in (1, 2, 3):
        raise ImportProblem(
            f"{path}: {node_name(node, axis)} has no known place and direction: write datasets 15"
            " (nodes) and 164 (units) to the file"
        )
    direction = tuple((np.sign(axis) * np.eye(3)[abs(axis) - 1]).tolist())
    return Channel(node_name(node, axis), nodes[node], direction, "", kind)


def _lines(data, kind, units, path):
    """Return (frequency (line,) Hz, response (line,) in SI per N) of a dataset."""
    label, below = (
        str(data.get(f"{part}_axis_units_lab") or "").strip().replace("NONE", "")
        for part in ("ordinate", "orddenom")
    )
    above, _, force = (part.strip("() ") for part in label.rpartition("/"))
    try:
        si_factor(force, "force")
    except UnitError:  # m/s^2 is not a unit per second squared
        above, force = label, below
    above = above or unit_of({}, int(data["ordinate_spec_data_type"]), units)[0]
    force = force or unit_of({}, FORCE_TYPES[0], units)[0]
    try:
        factor = si_factor(above, kind) / si_factor(force, "force")
    except UnitError as error:
        raise ImportProblem(
            f"{path}: a frequency response {error} (its label is '{label}')"
        ) from error
    return np.asarray(data["x"], float), factor * np.asarray(data["data"], complex)
