"""The command `vibroimpact wear`: its arguments, its output and its files.

The library is imported when the command runs, so that `--help` answers at once.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibroimpact.config.wear import Wear

    from .life import WearRow

HEADER = ("gap", "load", "support", "land", "work rate", "depth", "of the wall", "limit after")
KEYS = {  # argument -> key of the section `wear`
    "coefficient": "coefficient_m2_per_N",
    "slowing": "slowing",
    "years": "years",
    "duty": "duty",
    "limit": "wall_limit",
    "tilt": "tilt_deg",
    "tube_share": "tube_share",
    "gap_grows": "gap_grows",
}
FOREVER = 1e4  # years, above which the time to the limit is not shown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("study", metavar="STUDY", help="results of a study: its name, or a folder")
    parser.add_argument(
        "--coefficient",
        type=float,
        nargs="+",
        metavar="K",
        help="wear coefficients in m²/N, such as 1e-15 2e-14: they differ by 100 between alloys;"
        " by default the published ones of the support's shape",
    )
    parser.add_argument(
        "--slowing", action="store_true", default=None, help="with the slowing law EDF_MZ"
    )
    parser.add_argument("--years", type=float, help="time in service (default: 40)")
    parser.add_argument("--duty", type=float, help="share of it under the load (default: 1)")
    parser.add_argument(
        "--limit", type=float, help="share of the wall that may be worn (default: 0.4)"
    )
    parser.add_argument(
        "--tilt", type=float, metavar="DEG", help="of flat lands on the tube (default: 0)"
    )
    parser.add_argument(
        "--tube-share", type=float, help="share of the worn volume that is the tube's (default: 1)"
    )
    parser.add_argument(
        "--gap-grows",
        action="store_true",
        default=None,
        help="the gap grows by the depth: the work rate is that of the study at that gap",
    )
    parser.add_argument("--csv", metavar="FILE", help="write the rows of all loads to a CSV file")
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Run the command. Return 1 if there is no answer."""
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.io.records import RecordError, write_table

    from .life import NoWear

    try:
        named = Path("results") / options.study
        folder = named if (named / "records").is_dir() else Path(options.study)
        wear = _wear(options, folder / "config.yaml")
        rows = wear_life(folder, wear)
        if options.csv:
            write_table([asdict(row) for row in rows], options.csv)
    except (ConfigError, NoWear, RecordError) as error:
        print(error, file=sys.stderr)
        return 1
    print(as_text(rows, wear.years))
    return 0


def _wear(options: argparse.Namespace, configuration: Path) -> "Wear":
    """Return the section `wear` of a configuration, with the arguments in place of its keys.

    Raises NoWear for a value out of range, ConfigError.
    """
    from pydantic import ValidationError

    from vibroimpact.config.reading import load_config
    from vibroimpact.config.wear import Wear

    from .life import NoWear

    own = load_config(configuration).wear if configuration.is_file() else None
    given = {key: getattr(options, name) for name, key in KEYS.items()}
    keys = {} if own is None else own.model_dump()
    keys |= {key: value for key, value in given.items() if value is not None}
    try:
        return Wear(**keys)
    except ValidationError as error:
        flags = {key: name.replace("_", "-") for name, key in KEYS.items()}
        raise NoWear(
            "\n".join(
                f"--{flags[str(problem['loc'][0])]} {problem['input']:g} {problem['msg']}"
                for problem in error.errors()
            )
        ) from error


def wear_life(folder: Path, wear: "Wear") -> "list[WearRow]":
    """Return the WearRows of a study's folder.

    Raises NoWear, ConfigError, and RecordError if a record is missing or of another configuration
    than config.yaml there.
    """
    from vibroimpact.config.reading import load_config
    from vibroimpact.study.own_results import usable_records
    from vibroimpact.study.run_files import CONFIG_FILE

    from .life import NoWear, wear_rows

    if not any((folder / "records").glob("*.nc")):
        raise NoWear(f"{folder / 'records'}: there are no records: give the results of a study")
    config = load_config(folder / CONFIG_FILE)
    return wear_rows(config, usable_records(folder, config), wear)


def as_text(rows: "Sequence[WearRow]", years: float) -> str:
    """Return the land that wears deepest at each gap and load, as text."""
    from .life import deepest

    cells = [HEADER, *map(_cells, deepest(rows))]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in cells]
    return "\n".join([f"The land that wears deepest, after {years:g} years:", *lines])


def _cells(rows: "Sequence[WearRow]") -> tuple[str, ...]:
    """Return the texts of one support; rows: one for each coefficient."""
    first = rows[0]
    times = sorted(row.years_to_limit for row in rows)
    after = _span(times, 1.0) + " years" if times[0] < FOREVER else f"more than {FOREVER:g} years"
    return (
        f"{1e3 * first.gap_m:.4g} mm",
        f"{first.load_rms_N:.4g} N",
        first.support,
        str(first.land),
        f"{1e3 * first.work_rate_W:.3g} mW",
        _span(sorted(row.depth_m for row in rows), 1e6) + " µm",
        _span(sorted(row.wall_share for row in rows), 100.0) + " %",
        after,
    )


def _span(values: Sequence[float], factor: float) -> str:
    """Return a range as text."""
    low, high = factor * values[0], factor * values[-1]
    return f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
