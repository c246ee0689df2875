"""The sidecar campaign.yaml: which signals are the channels and records of a campaign.

It also states the values that the files lack.
"""

import copy
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, ValidationError

from vibroimpact.campaign.file import Kind
from vibroimpact.campaign.force_kinds import ForceKind
from vibroimpact.config.problems import ConfigError, follows, in_words, shown
from vibroimpact.config.quantities import (
    Band_Hz,
    Frequency_Hz,
    Length,
    Number,
    Pattern,
    Range,
    Section,
    Whole,
)
from vibroimpact.config.yaml_file import read_yaml
from vibroimpact.io.signal_files.signals import ImportProblem

NAME = "campaign.yaml"
# Keys whose contradictions are reported: without a wrong value there would be one too many.
CONTRADICTING = ("name", "file", "files", "from_s", "to_s", "variables", "support_gap_m")
Direction = Literal["x", "y", "z", "+x", "+y", "+z", "-x", "-y", "-z"]
DIRECTIONS = {
    name: tuple((-1.0 if name[0] == "-" else 1.0) * float(name[-1] == axis) for axis in "xyz")
    for name in get_args(Direction)
}
# Control characters, and marks that change the direction of writing.
CONTROL = (
    r"\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"
    r"\ufeff"
)
Label = Annotated[
    str,
    Pattern(
        "a text of 1 to 100 characters on one line, without spaces at its ends",
        rf"(?!\s)[^{CONTROL}\n\r\t]{{1,100}}(?<!\s)",
    ),
]
Text = Annotated[str, Pattern("a text without control characters", rf"[^{CONTROL}]{{0,1000}}")]
THREE = Length("give three, along x, y and z", 3)
Point_m = Annotated[
    tuple[Annotated[Number, Range("in metres", at_least=-1000, at_most=1000)], ...], THREE
]
Vector = Annotated[
    tuple[Annotated[Number, Range("only the ratio counts", at_least=-1e6, at_most=1e6)], ...], THREE
]
Clearance_m = Annotated[
    Number, Range("the radial clearance in metres, 0.2 mm is 2.0e-4", at_least=0, at_most=0.1)
]
Time_s = Annotated[Number, Range("seconds from the start of the file", at_least=0, at_most=1e7)]
Repeat = Annotated[
    Whole, Range("0 for the first record of its load and gap", at_least=0, at_most=10**6)
]
PeriodSamples = Annotated[
    Whole, Range("samples of a period, 0 if the force is not periodic", at_least=0, at_most=10**9)
]
TransientPeriods = Annotated[
    Whole, Range("periods before the steady state", at_least=0, at_most=10**6)
]


class Sensor(Section):
    """A response channel.

    name: of the channel.
    variable: name of the signal in the files; the same if it is not given.

    Other keys state values that the files lack.
    """

    name: Label
    variable: str | None = None
    unit: Text | None = None
    kind: Kind | None = None
    point_m: Point_m | None = None
    direction: Direction | Vector | None = None


class Drive(Sensor):
    """A force, or an acceleration of the base, which needs no point_m.

    remove_offset: the median of the signal is taken out, which blows of a hammer do not move.
    """

    kind: ForceKind | Kind | None = None  # type: ignore[assignment]
    remove_offset: bool = False


class Record(Section):
    """A record: its files and the conditions of the measurement.

    variables: {sensor: signal} if the names of signals differ between records.
    from_s, to_s: part of the record that is used.
    """

    name: Label | None = None
    file: str | None = None
    files: tuple[str, ...] = ()
    gap_m: Clearance_m | None = None
    support_gap_m: Annotated[tuple[Clearance_m, ...], Field(min_length=1)] | None = None
    split: Literal["fit", "holdout"] = "fit"
    repeat: Repeat | None = None
    from_s: Time_s | None = None
    to_s: Time_s | None = None
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

    source: Text = ""
    sampling_frequency_Hz: Frequency_Hz | None = None
    band_Hz: Band_Hz | None = None
    antialias: Text = "unknown"
    start_up: Literal["rest", "stationary"] = "stationary"
    period_samples: PeriodSamples = 0
    transient_periods: TransientPeriods = 0
    forces: tuple[Drive, ...]  # none if no force was measured
    channels: tuple[Sensor, ...] = Field(min_length=1)
    records: tuple[Record, ...] = Field(min_length=1)
    voltage: Voltage | None = None


def read_sidecar(path: str | Path) -> Sidecar:
    """Return the Sidecar of a YAML file.

    Raises ImportProblem with every problem, its place and the expected value.
    """
    try:
        data = read_yaml(path)
    except ConfigError as error:
        raise ImportProblem(str(error)) from error
    problems: list[str] = []
    try:
        sidecar: Sidecar | None = Sidecar.model_validate(data)
    except ValidationError as error:
        errors = [each for each in error.errors(include_url=False) if not follows(each)]
        problems += [_sentence(path, each, data) for each in errors]
        sidecar = _without(data, errors)
    if sidecar is not None:
        problems += [f"{path}: {problem}" for problem in _contradictions(sidecar)]
    if problems or sidecar is None:
        raise ImportProblem("\n".join(dict.fromkeys(problems)))
    return sidecar


def _without(data: dict[str, Any], errors: Sequence[Mapping[str, Any]]) -> Sidecar | None:
    """Return the Sidecar without the keys that are wrong, to find further problems; None if more is
    wrong than keys that may be left out.
    """
    rest = copy.deepcopy(data)
    for error in errors:
        level, last = None, None
        value: Any = rest
        for part in error["loc"]:
            keys = range(len(value)) if isinstance(value, list) else value
            if not isinstance(value, (dict, list)) or part not in keys:
                break
            if isinstance(value, dict):
                level, last = value, part
            value = value[part]
        if level is None or last in CONTRADICTING:
            return None
        level.pop(last, None)
    try:
        return Sidecar.model_validate(rest)
    except ValidationError:
        return None


def _contradictions(sidecar: Sidecar) -> Iterator[str]:
    """Yield a sentence for everything that does not fit together."""
    sensors = [sensor.name for sensor in (*sidecar.forces, *sidecar.channels)]
    for name in sorted({name for name in sensors if sensors.count(name) > 1}):
        yield (
            f"the name '{name}' is given to {sensors.count(name)} forces and channels: give each a"
            " name of its own"
        )
    for index, record in enumerate(sidecar.records):
        place = f"records[{index}]"
        if not record.all_files():
            yield f"{place} names no file: give file or files"
        if record.to_s is not None and record.to_s <= (record.from_s or 0.0):
            yield (
                f"{place}.to_s = {record.to_s:g} is not after from_s = {record.from_s or 0:g}: give"
                " the end of the part that is used"
            )
        for name in record.variables:
            if name not in (*sensors, "voltage"):
                yield (
                    f"{place}.variables: '{name}' is no force and no channel: they are"
                    f" {', '.join(sensors)}"
                )
    if all(record.all_files() for record in sidecar.records):
        names = record_names(sidecar.records)
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield f"{names.count(name)} records are called '{name}': give each a name of its own"
    given = {record.support_gap_m and len(record.support_gap_m) for record in sidecar.records}
    if len(given) > 1:
        yield (
            "support_gap_m has another number of supports in some records, or is missing there:"
            " give one clearance per support in every record"
        )


def record_names(records: tuple[Record, ...]) -> list[str]:
    """Return the name of each record: its own, else that of its first file.

    A file that is cut into several records gives `run`, `run_2`, `run_3`.
    """
    names: list[str] = []
    for record in records:
        stem = Path(record.all_files()[0]).stem
        earlier = sum(
            other.name is None and Path(other.all_files()[0]).stem == stem
            for other in records[: len(names)]
        )
        names.append(record.name or (f"{stem}_{earlier + 1}" if earlier else stem))
    return names


def _sentence(path: str | Path, error: Mapping, data: Any) -> str:
    """Return the sentence of a pydantic error of the content `data` of a file."""
    place, value = "", data
    for part in error["loc"]:
        inside = isinstance(value, dict) and part in value
        inside |= isinstance(value, list) and isinstance(part, int) and part < len(value)
        if inside:
            value = value[part]
        elif error["type"] not in ("missing", "extra_forbidden"):
            continue  # names the member of a union, or says that the key itself is wrong
        place += f"[{part}]" if isinstance(part, int) else f".{part}"
    place = place.removeprefix(".")
    if error["type"] == "missing":
        return f"{path}: {place} is missing: docs/bring_your_own.md shows it"
    if error["type"] == "extra_forbidden":
        return f"{path}: unknown key {place}: docs/bring_your_own.md shows those there are"
    return f"{path}: {place} = {shown(value)} {in_words(error)}"
