"""The command `vibroimpact wear`: its arguments, and what it prints and writes.

The library is imported when the command runs, so that `--help` answers at once.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .life import WearRow

HEADER = ("gap", "load", "support", "work rate", "depth", "of the wall", "limit after")
FOREVER = 1e4  # years, above which the time to the limit is not told


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("study", metavar="STUDY", help="results of a study: its name, or a folder")
    parser.add_argument(
        "--coefficient",
        type=float,
        nargs="+",
        required=True,
        metavar="K",
        help="wear coefficients in m²/N, such as 1e-15 2e-14: they differ by 100 between alloys",
    )
    parser.add_argument("--years", type=float, default=40.0, help="time in service (default: 40)")
    parser.add_argument(
        "--duty", type=float, default=1.0, help="share of it under the load (default: 1)"
    )
    parser.add_argument(
        "--limit", type=float, default=0.4, help="share of the wall that may be worn (default: 0.4)"
    )
    parser.add_argument("--csv", metavar="FILE", help="write the rows of all loads to a CSV file")
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Run the command. Return 1 where there is no answer."""
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.io.records import RecordError, write_table

    from .life import NoWear, Service, wear_life

    try:
        _require(options)
        service = Service(tuple(options.coefficient), options.years, options.duty, options.limit)
        named = Path("results") / options.study
        folder = named if (named / "records").is_dir() else Path(options.study)
        rows = wear_life(folder, service)
        if options.csv:
            write_table([asdict(row) for row in rows], options.csv)
    except (ConfigError, NoWear, RecordError) as error:
        print(error, file=sys.stderr)
        return 1
    print(as_text(rows, service.years))
    return 0


def _require(options: argparse.Namespace) -> None:
    """Raise NoWear for numbers that no wear has."""
    from .life import NoWear

    for value in options.coefficient:
        if not 0.0 < value < 1e-6:
            raise NoWear(f"--coefficient {value:g} must be between 0 and 1e-6 m²/N")
    for name, highest in (("years", 1e4), ("duty", 1.0), ("limit", 1.0)):
        value = getattr(options, name)
        if not 0.0 < value <= highest:
            raise NoWear(f"--{name} {value:g} must be above 0 and at most {highest:g}")


def as_text(rows: Sequence[WearRow], years: float) -> str:
    """Return the support that wears most at each gap and load, as text."""
    worst: dict[tuple[float, float], list[WearRow]] = {}
    for row in rows:
        own = worst.setdefault((row.gap_m, row.load_rms_N), [])
        if not own or row.work_rate_W > own[0].work_rate_W:
            worst[row.gap_m, row.load_rms_N] = [row]
        elif row.support == own[0].support:
            own.append(row)
    cells = [HEADER, *map(_cells, worst.values())]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in cells]
    return "\n".join([f"The support that wears most, after {years:g} years:", *lines])


def _cells(rows: Sequence[WearRow]) -> tuple[str, ...]:
    """Return the texts of one support; rows: one for each coefficient."""
    first = rows[0]
    times = sorted(row.years_to_limit for row in rows)
    after = _span(times, 1.0) + " years" if times[0] < FOREVER else f"more than {FOREVER:g} years"
    return (
        f"{1e3 * first.gap_m:.4g} mm",
        f"{first.load_rms_N:.4g} N",
        first.support,
        f"{1e3 * first.work_rate_W:.3g} mW",
        _span(sorted(row.depth_m for row in rows), 1e6) + " µm",
        _span(sorted(row.wall_share for row in rows), 100.0) + " %",
        after,
    )


def _span(values: Sequence[float], factor: float) -> str:
    """Return a range as text."""
    low, high = factor * values[0], factor * values[-1]
    return f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
