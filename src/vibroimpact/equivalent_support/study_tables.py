"""The tables of a study as the answer needs them: by method, and recommended."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from vibroimpact.config.problems import ConfigError
from vibroimpact.config.reading import Config
from vibroimpact.config.stage_keys import answer_digest
from vibroimpact.config.yaml_file import read_yaml
from vibroimpact.io.records import RecordError, read_table
from vibroimpact.study.equivalent_table import DIGEST_COLUMN, EQUIVALENT_COLUMNS, equivalent_rows
from vibroimpact.study.own_results import other_configuration
from vibroimpact.study.run_files import CONFIG_FILE

from .answer import EquivalentError

SUMMARY, RECOMMENDED = "consistency_summary.csv", "equivalent.csv"
TEXTS = (DIGEST_COLUMN, "group", "direction")  # columns: a name may read as a number
METHODS_COLUMNS = ("group", "direction", "verdict_k", "verdict_c", "reason", "flag")  # of SUMMARY


def summary_rows_of(folder: Path) -> list[dict[str, Any]]:
    """Return the rows of consistency_summary.csv: per gap, load, group, direction and method.

    Raises EquivalentError if the folder holds no such table, or it has no rows.
    """
    path = folder / SUMMARY
    try:
        rows = read_table(path, TEXTS)
    except RecordError as error:
        raise EquivalentError(
            f"{path}: is not there: name a finished study with identification, as in"
            " `vibroimpact equivalent gv_local`, or its folder"
        ) from error
    if not rows:
        raise EquivalentError(f"{path}: has no rows: the study identified nothing")
    _require_columns(path, rows, METHODS_COLUMNS)
    _require_own(path, rows)
    return rows


def recommended_rows_of(folder: Path, summary: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the rows of equivalent.csv: per gap, load, group and direction. They are made of the
    summary if the study does not have the table.
    """
    path = folder / RECOMMENDED
    if not path.is_file():
        return equivalent_rows(summary)
    rows = read_table(path, TEXTS)
    _require_columns(path, rows, EQUIVALENT_COLUMNS)
    _require_own(path, rows)
    return rows


def _require_columns(path: Path, rows: list[dict[str, Any]], columns: Sequence[str]) -> None:
    """Raise EquivalentError if a table lacks columns, other than the digest."""
    lacks = {*columns} - {DIGEST_COLUMN} - rows[0].keys() if rows else ()
    if lacks:
        raise EquivalentError(
            f"{path}: lacks the columns {', '.join(sorted(lacks))}, as a table of an older version"
            " does: run the study again"
        )


def _require_own(path: Path, rows: list[dict[str, Any]]) -> None:
    """Raise EquivalentError if a table is of another configuration than that of its folder.

    Tables without the column, and copies without a configuration in their folder, are taken.
    """
    beside = path.parent / CONFIG_FILE
    if not beside.is_file():
        return
    try:
        current = answer_digest(read_yaml(beside))
    except (ConfigError, LookupError, TypeError) as error:
        raise EquivalentError(f"{beside}: is not the configuration of a run ({error})") from error
    if {row.get(DIGEST_COLUMN, current) for row in rows} != {current}:
        raise EquivalentError(other_configuration(path, beside))


def require_tables_of(folder: Path, config: Config, source: str) -> None:
    """Raise EquivalentError if the tables of a folder are of another configuration than one that
    is given. Tables without the column are taken.

    source: the file of the configuration.
    """
    current = answer_digest(config.model_dump(mode="json"))
    for path in filter(Path.is_file, (folder / SUMMARY, folder / RECOMMENDED)):
        if {row.get(DIGEST_COLUMN, current) for row in read_table(path, TEXTS)} - {current}:
            raise EquivalentError(
                f"{path}: is of another configuration than {source}: run `snakemake -j2"
                f" --configfile {source}` to the end first, or name the configuration of the study"
            )
