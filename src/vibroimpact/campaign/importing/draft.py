"""A draft of campaign.yaml for a folder of measurements that has none."""

import json
from pathlib import Path

from vibroimpact.io.records import write_text
from vibroimpact.io.signal_files.signals import ImportProblem, Signal

from .assemble import import_folder
from .raw_files import raw_files, read_signals
from .sidecar import DIRECTIONS, NAME

UNKNOWN = "FILL_IN"
HEAD = (
    "# Complete every FILL_IN, or delete its key if there is none. Delete signals that are no"
    " sensors, and list forces under 'forces'."
)


def checked_folder(folder: str | Path, draft: str | Path) -> list[Path]:
    """Return the files that the import of a folder reads, after an import that wrote nothing.

    draft: path of the draft of campaign.yaml, which is written if the folder has none.

    Raises ImportProblem with every problem, and the path of the draft.
    """
    files = raw_files(folder)
    described = files[0].name == NAME
    try:
        if not described:
            write_text(draft_sidecar(folder, files), draft)
        import_folder(folder)
    except ImportProblem as problem:
        remedy = f"\n{draft} is a draft of {NAME}: complete it and put it into {folder} as {NAME}"
        raise ImportProblem(f"{problem}{'' if described else remedy}") from problem
    return files


def draft_sidecar(folder: str | Path, files: list[Path]) -> str:
    """Return the text of a campaign.yaml to be completed by the user.

    It has the signals of the first file that can be read, and every file as a record.
    """
    signals: list[Signal] = []
    for file in files:
        try:
            signals = signals or read_signals([file])[file.name]
        except ImportProblem:  # the import says why; its record is listed all the same
            continue
    forces = [_sensor(signal) for signal in signals if signal.force]
    responses = [_sensor(signal) for signal in signals if not signal.force]
    rated = not signals or any(signal.rate for signal in signals)
    return "\n".join(
        [
            HEAD,
            f"source: {_quoted(Path(folder).name)}",
            *([] if rated else [f"sampling_frequency_Hz: {UNKNOWN}"]),
            "forces:",
            *(forces or [_sensor(None)]),
            "channels:",
            *(responses or [_sensor(None)]),
            "records:",
            *(
                f"  - {{file: {_quoted(file.name)}, gap_m: {UNKNOWN}, split: fit}}"
                for file in files
            ),
            "",
        ]
    )


def _sensor(signal: Signal | None) -> str:
    """Return the line of a sensor, None for one that is not known."""
    name = unit = kind = direction = UNKNOWN
    point = f"[{', '.join([UNKNOWN] * 3)}]"
    if signal is not None:
        name, unit = _quoted(signal.name), _quoted(signal.unit) if signal.unit else UNKNOWN
        kind, point = signal.kind or kind, str(list(signal.point)) if signal.point else point
        axes = (text for text, axis in DIRECTIONS.items() if axis == signal.direction and text[1:])
        direction = next(axes, UNKNOWN)
    of_kind = "" if signal is None or signal.force else f", kind: {kind}"
    return (
        f"  - {{name: {name}, variable: {name}, unit: {unit}{of_kind}, point_m: {point},"
        f" direction: {direction}}}"
    )


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
