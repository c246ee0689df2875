"""The files of a run in addition to its results: its configuration and provenance."""

import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import yaml

from vibroimpact import __version__
from vibroimpact.io.provenance import config_digest, package_digest, versions
from vibroimpact.io.records import write_text

CONFIG_FILE, PROVENANCE_FILE = "config.yaml", "provenance.json"


def write_run_files(
    folder: str | Path, values: Mapping[str, Any] | None, command: Sequence[str]
) -> None:
    """Write config.yaml and provenance.json of a run into a folder of results.

    values: the checked configuration with all defaults, None if the run has none.
    command: program and arguments of the run.
    """
    folder = Path(folder)
    if values is not None:
        write_text(configuration_text(values, folder), folder / CONFIG_FILE)
    text = json.dumps(run_provenance(values, command), indent=2) + "\n"
    write_text(text, folder / PROVENANCE_FILE)


def configuration_text(values: Mapping[str, Any], folder: Path) -> str:
    """Return a configuration as YAML, which runs again as it stands."""
    head = (
        f"# The configuration of {folder.name} as it ran, every default written out. To run it"
        " again:\n"
        f"# snakemake -j2 --configfile {(folder / CONFIG_FILE).as_posix()}\n"
    )
    return head + yaml.safe_dump(dict(values), sort_keys=False, allow_unicode=True, width=100)


def run_provenance(values: Mapping[str, Any] | None, command: Sequence[str]) -> dict[str, Any]:
    """Return the origin of the results of a run, as provenance.json holds it.

    It is of the last run that made anything in the folder. Each netCDF file states that of itself
    in its attributes, which is older if the run did not have to make the file again.
    """
    return {
        "vibroimpact_version": __version__,
        "package_digest": package_digest(),
        "config_digest": None if values is None else config_digest(values),
        "versions": versions(),
        "command": " ".join([Path(command[0]).name, *command[1:]]),
        "started": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}",
    }
