"""The checks of a model before a run, once per model: they import and build all of it."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from vibroimpact.config.schema import Config
from vibroimpact.io.provenance import config_digest, package_digest
from vibroimpact.io.whole_file import RecordError, whole_file

PASSED = Path(".snakemake/vibroimpact_models")  # a file of warnings for each model that passed


def model_warnings(config: Config, source: str) -> list[str]:
    """Return the warnings on the model of a configuration, after all its checks.

    source: the files of the configuration, for messages.
    A model that passed is checked again when its configuration, a file that this names, or the
    library changes. Raises SystemExit with every problem.
    """
    values = config.model_dump(mode="json")
    digest = config_digest(
        {"values": values, "files": sorted(files_named(values)), "library": package_digest()}
    )
    passed = PASSED / f"{digest}.json"
    if passed.is_file():
        return json.loads(passed.read_text(encoding="utf-8"))
    from vibroimpact.study.model_checks import check_model

    found = check_model(config)
    if found.problems:
        sys.exit("\n".join(f"{source}: {text}" for text in found.problems))
    try:
        with whole_file(passed) as temporary:
            temporary.write_text(json.dumps(found.warnings), encoding="utf-8")
    except RecordError:  # the run says so in its own words
        pass
    return list(found.warnings)


def files_named(value: Any) -> Iterator[tuple[str, int, int]]:
    """Yield (path, size, time of the last change in ns) of the files that a configuration names."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for item in value:
            yield from files_named(item)
    elif isinstance(value, str) and os.path.isfile(value):
        found = os.stat(value)
        yield value, found.st_size, found.st_mtime_ns
