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
    """Write config.yaml, which runs again as it stands, and provenance.json of a run into a folder
    of results. It is of the last run that made anything in the folder. Each netCDF file states that
    of itself in its attributes, which is older if the run did not have to make the file again.

    values: the checked configuration with all defaults, None if the run has none.
    command: program and arguments of the run.
    """
    folder = Path(folder)
    if values is not None:
        head = (
            f"# The configuration of {folder.name} as it ran, every default written out. To run it"
            " again:\n"
            f"# snakemake -j2 --configfile {(folder / CONFIG_FILE).as_posix()}\n"
        )
        own = yaml.safe_dump(dict(values), sort_keys=False, allow_unicode=True, width=100)
        write_text(head + own, folder / CONFIG_FILE)
    provenance = {
        "vibroimpact_version": __version__,
        "package_digest": package_digest(),
        "config_digest": None if values is None else config_digest(values),
        "versions": versions(),
        "command": " ".join([Path(command[0]).name, *command[1:]]),
        "started": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}",
    }
    write_text(json.dumps(provenance, indent=2) + "\n", folder / PROVENANCE_FILE)
