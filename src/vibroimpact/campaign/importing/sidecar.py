"""The sidecar campaign.yaml: which signals are the channels and records of a campaign.

It also gives what the files do not state.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal, get_args

from pydantic import Field, ValidationError

from vibroimpact.campaign.file import Kind
from vibroimpact.config.problems import PLAIN_WORDS, ConfigError
from vibroimpact.config.quantities import Frequency_Hz, Number, Range, Section, Vector, Whole
from vibroimpact.config.yaml_file import read_yaml

from .signals import ImportProblem, Signal

NAME = "campaign.yaml"
Direction = Literal["x", "y", "z", "+x", "+y", "+z", "-x", "-y", "-z"]
DIRECTIONS = {
    name: tuple((-1.0 if name[0] == "-" else 1.0) * float(name[-1] == axis) for axis in "xyz")
    for name in get_args(Direction)
}
Repeat = Annotated[
    Whole, Range("0 for the first record of its load and gap", at_least=0, at_most=10**6)
]
PeriodSamples = Annotated[
    Whole,
    Range("samples of a period, 0 where the force is not periodic", at_least=0, at_most=10**9),
]
TransientPeriods = Annotated[
    Whole, Range("periods before the steady state", at_least=0, at_most=10**6)
]


class Sensor(Section):
    """A response channel or a force.

    name: of the channel.
    variable: name of the signal in the files; the same where it is not given.

    Other keys give what the files do not state.
    """

    name: str
    variable: str | None = None
    unit: str | None = None
    kind: Kind | None = None
    point_m: Vector | None = None
    direction: Direction | Vector | None = None


class Record(Section):
    """A record: its files and the conditions of the measurement.

    variables: {sensor: signal} where the names of signals differ between records.
    from_s, to_s: part of the record that is used.
    """

    name: str | None = None
    file: str | None = None
    files: tuple[str, ...] = ()
    gap_m: Number | None = None
    support_gap_m: tuple[Number, ...] | None = None
    split: Literal["fit", "holdout"] = "fit"
    repeat: Repeat | None = None
    from_s: Number | None = None
    to_s: Number | None = None
    variables: dict[str, str] = {}

    def all_files(self) -> tuple[str, ...]:
        """Return the names of the record's files."""
        return (*([self.file] if self.file else []), *self.files)


class Voltage(Section):
    """The voltage that drove the shaker."""

    variable: str
    unit: str


class Sidecar(Section):
    """The content of a campaign.yaml."""

    source: str = ""
    sampling_frequency_Hz: Frequency_Hz | None = None
    antialias: str = "unknown"
    start_up: Literal["rest", "stationary"] = "stationary"
    period_samples: PeriodSamples = 0
    transient_periods: TransientPeriods = 0
    forces: tuple[Sensor, ...] = Field(min_length=1)
    channels: tuple[Sensor, ...] = Field(min_length=1)
    records: tuple[Record, ...] = Field(min_length=1)
    voltage: Voltage | None = None


def read_sidecar(path: str | Path) -> Sidecar:
    """Return the Sidecar of a YAML file.

    Raises ImportProblem with every problem, its place and what is expected.
    """
    try:
        data = read_yaml(path)
    except ConfigError as error:
        raise ImportProblem(
            str(error).replace("config/study.yaml", "docs/bring_your_own.md")
        ) from error
    try:
        sidecar = Sidecar.model_validate(data)
    except ValidationError as error:
        raise ImportProblem(
            "\n".join(_sentence(path, line) for line in error.errors(include_url=False))
        ) from error
    problems = [
        f"{path}: records[{index}] names no file: give file or files"
        for index, record in enumerate(sidecar.records)
        if not record.all_files()
    ]
    for group in ("forces", "channels"):
        names = [sensor.name for sensor in getattr(sidecar, group)]
        problems += [
            f"{path}: {group}: the name '{name}' is given twice"
            for name in sorted({name for name in names if names.count(name) > 1})
        ]
    if problems:
        raise ImportProblem("\n".join(problems))
    return sidecar


def _sentence(path: str | Path, line: Mapping) -> str:
    place = "".join(
        f"[{part}]" if isinstance(part, int) else f".{part}" for part in line["loc"]
    ).removeprefix(".")
    if line["type"] == "missing":
        return f"{path}: {place} is missing: docs/bring_your_own.md shows it"
    if line["type"] == "extra_forbidden":
        return f"{path}: unknown key {place}: docs/bring_your_own.md shows those there are"
    text = PLAIN_WORDS.get(line["type"]) or line["msg"].replace("Input should be", "must be")
    return f"{path}: {place} = {line['input']!r} {text}"


def draft_sidecar(folder: str | Path, signals: list[Signal]) -> str:
    """Return the text of a campaign.yaml to be completed by the user.

    It has every signal of the first file, and every file as a record.
    """
    lines = [
        (
            "# Fill in every ???, delete the signals that are not channels, then move the forces"
            " to 'forces'."
        ),
        f"source: {Path(folder).name}",
        "forces:",
        "  - {name: ???, variable: ???, unit: N, point_m: [???, ???, ???], direction: ???}",
        "channels:",
    ]
    first = signals[0].file if signals else ""
    for signal in (signal for signal in signals if signal.file == first):
        direction = next(
            (
                text
                for text, vector in DIRECTIONS.items()
                if vector == signal.direction and len(text) == 2
            ),
            "???",
        )
        place = list(signal.point) if signal.point else "[???, ???, ???]"
        lines.append(
            f"  - {{name: {signal.name!r}, variable: {signal.name!r}, unit: {signal.unit or '???'},"
            f" kind: {signal.kind or '???'}, point_m: {place}, direction: {direction}}}"
        )
    files = dict.fromkeys(Path(signal.file).name for signal in signals)
    records = [f"  - {{file: {name!r}, gap_m: ???, split: fit}}" for name in files]
    return "\n".join([*lines, "records:", *records]) + "\n"
