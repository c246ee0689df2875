"""The sidecar campaign.yaml: which signals of which files are which channels and records, and what
no file says.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, ValidationError

from vibroimpact.campaign.file import KINDS
from vibroimpact.config.problems import PLAIN_WORDS, ConfigError
from vibroimpact.config.quantities import Frequency_Hz, Number, Range, Section, Vector, Whole
from vibroimpact.config.yaml_file import read_yaml

from .signals import ImportProblem

NAME = "campaign.yaml"
DIRECTIONS = {
    f"{sign}{axis}": tuple((-1.0 if sign == "-" else 1.0) * float(axis == other) for other in "xyz")
    for sign in ("", "+", "-")
    for axis in "xyz"
}


class Sensor(Section):
    """A channel or a force: its name, the signal's name in the files (default: the same), and what
    the files do not say.
    """

    name: str
    variable: str | None = None
    unit: str | None = None
    kind: Literal[KINDS] | None = None
    point_m: Vector | None = None
    direction: Literal[tuple(DIRECTIONS)] | Vector | None = None


class Record(Section):
    """A record: its file or files, and what was set when it was taken. variables: {sensor: signal}
    where the names differ from record to record.
    """

    name: str | None = None
    file: str | None = None
    files: tuple[str, ...] = ()
    gap_m: Number | None = None
    support_gap_m: tuple[Number, ...] | None = None
    split: Literal["fit", "holdout"] = "fit"
    repeat: (
        Annotated[
            Whole,
            Range("0 for the first record of its load and gap", at_least=0, at_most=10**6),
        ]
        | None
    ) = None
    from_s: Number | None = None
    to_s: Number | None = None
    variables: dict[str, str] = {}

    def all_files(self):
        """Return the names of the record's files."""
        return (*([self.file] if self.file else []), *self.files)


class Voltage(Section):
    """The voltage that drove the shaker."""

    variable: str
    unit: str


class Sidecar(Section):
    """A whole campaign.yaml."""

    source: str = ""
    sampling_frequency_Hz: Frequency_Hz | None = None
    antialias: str = "unknown"
    start_up: Literal["rest", "stationary"] = "stationary"
    period_samples: Annotated[
        Whole,
        Range("samples of a period, 0 where the force is not periodic", at_least=0, at_most=10**9),
    ] = 0
    transient_periods: Annotated[
        Whole, Range("periods before the steady state", at_least=0, at_most=10**6)
    ] = 0
    forces: tuple[Sensor, ...] = Field(min_length=1)
    channels: tuple[Sensor, ...] = Field(min_length=1)
    records: tuple[Record, ...] = Field(min_length=1)
    voltage: Voltage | None = None


def read_sidecar(path):
    """Return the Sidecar of a YAML file. Raises ImportProblem with every problem, its place and
    what is expected.
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


def _sentence(path, line):
    place = "".join(
        f"[{part}]" if isinstance(part, int) else f".{part}" for part in line["loc"]
    ).removeprefix(".")
    if line["type"] == "missing":
        return f"{path}: {place} is missing: docs/bring_your_own.md shows it"
    if line["type"] == "extra_forbidden":
        return f"{path}: unknown key {place}: docs/bring_your_own.md shows those there are"
    text = PLAIN_WORDS.get(line["type"]) or line["msg"].replace("Input should be", "must be")
    return f"{path}: {place} = {line['input']!r} {text}"


def draft(folder, signals):
    """Return the text of a campaign.yaml to fill in for a folder: every signal found in its first
    file, and every file as a record.
    """
    lines = [
        (
            "# Fill in every ???, delete the signals that are no channels, then move the forces to"
            " 'forces'."
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
    return (
        "\n".join(
            [
                *lines,
                "records:",
                *(f"  - {{file: {name!r}, gap_m: ???, split: fit}}" for name in files),
            ]
        )
        + "\n"
    )
