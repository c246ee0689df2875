"""The command `vibroimpact supports`: its arguments, its output and its files.

The library is imported when the command runs, so that `--help` answers at once.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from dataclasses import asdict, fields
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

    from .supports import SupportValue

MODEL = "config/study.yaml"
HEADER = ("support", "quantity", "value", "90 % interval", "measured", "")
# Name of a quantity, and its unit as shown; the direction of a secant value follows.
SHOWN = {
    "rms_force": ("contact force, RMS", "N"),
    "force_level": ("contact force, 99.9 % level", "N"),
    "peak_force": ("contact force, peak", "N"),
    "contact_fraction": ("time in contact", ""),
    "impact_rate": ("impacts", "1/s"),
    "wear_work_rate": ("wear work rate", "W"),
    "secant_stiffness": ("secant stiffness along", "N/m"),
    "secant_damping": ("secant damping along", "N s/m"),
    "correlation": ("correlation with the measured force", ""),
    "agreement": ("agreement of two strengths of holding", ""),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("campaign", metavar="CAMPAIGN", help="a measured campaign (.nc)")
    parser.add_argument(
        "--model",
        metavar="FILE",
        default=MODEL,
        help=f"configuration of the model (default: {MODEL})",
    )
    parser.add_argument(
        "--calibrate",
        action="store_true",
        help="first fit the model's frequencies and damping and the sensors' gains, within what a"
        " good model is off by; takes some 20 s of CPU time",
    )
    parser.add_argument("--csv", metavar="FILE", help="write the table to a CSV file too")
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Run the command. Return 1 if there is no answer."""
    from vibroimpact.campaign.file import CampaignError
    from vibroimpact.config.problems import ConfigError
    from vibroimpact.config.reading import load_config
    from vibroimpact.io.records import RecordError, write_table

    from .supports import SupportValue, virtual_supports

    try:
        if options.model == MODEL and not Path(MODEL).is_file():
            raise ConfigError([f"there is no {MODEL} here: name the model with --model FILE.yaml"])
        config = load_config(options.model)
        campaign = _campaign(options.campaign)
        found = virtual_supports(campaign, config, calibrate=options.calibrate)
        if options.csv:
            columns = tuple(field.name for field in fields(SupportValue))
            write_table([asdict(value) for value in found.values], options.csv, columns)
    except CampaignError as error:
        _tell(options.campaign, str(error).split("\n"))
        return 1
    except (ConfigError, RecordError) as error:
        print(error, file=sys.stderr)
        return 1
    print(as_text(found.values))
    _tell(options.campaign, [f"warning: {note}" for note in found.notes])
    return 0


def _tell(path: str, lines: Iterable[str]) -> None:
    """Print lines about a file to the error stream."""
    for line in lines:
        print(f"{path}: {line}", file=sys.stderr)


def _campaign(path: str) -> xr.Dataset:
    """Return the usable part of a campaign, and report the rest. Raises CampaignError."""
    from vibroimpact.campaign.checks import file_checks
    from vibroimpact.campaign.file import CampaignError

    campaign, rows = file_checks.check_file(path)
    if campaign is None or file_checks.refused(rows):
        refusing = [row["message"] for row in rows if row["level"] == "refuse"]
        raise CampaignError("\n".join(refusing))
    excluding = [row for row in rows if row["check"] in file_checks.EXCLUDING_CHECKS]
    _tell(path, [f"warning: {row['message']}" for row in excluding if row["level"] == "warn"])
    force, response = file_checks.usable_signals(campaign, rows)
    usable = response[force].all(axis=0)
    if not usable.any():
        raise CampaignError("no channel and record is left that can be used: see above.")
    return campaign.isel(record=force.nonzero()[0], channel=usable.nonzero()[0])


def as_text(values: Sequence[SupportValue]) -> str:
    """Return the table of values as text, one block per record."""
    blocks = []
    for record, own in groupby(values, lambda value: value.record):
        rows = list(own)
        load, gap = rows[0].load, rows[0].gap_m
        shown = f", gap {1e3 * gap:.4g} mm" if gap == gap else ""
        cells = [HEADER, *map(_cells, rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = ["  ".join(["", *map(str.ljust, row, widths)]).rstrip() for row in cells]
        heading = f"Record {record}: {load:.4g} {rows[0].load_unit} RMS{shown}"
        blocks.append("\n".join([heading, *lines]))
    return "\n\n".join(blocks)


def _cells(value: SupportValue) -> tuple[str, ...]:
    """Return the texts of a row."""
    name, along = value.quantity, ""
    if name.startswith("secant"):
        name, along = name.rsplit("_", 1)
    label, unit = SHOWN[name]
    shown = f"{value.value:.4g} {unit}".rstrip() if value.value == value.value else "-"
    return (
        value.support,
        " ".join(filter(None, [label, along, value.channel and f"({value.channel})"])),
        shown,
        f"{value.low:.4g} to {value.high:.4g}" if value.low == value.low else "",
        f"{value.measured:.4g}" if value.measured == value.measured else "",
        value.remark,
    )
