"""The tables of a study as the answer needs them: by method, and recommended."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.config.problems import ConfigError
from vibroimpact.config.reading import Config
from vibroimpact.config.stage_keys import answer_digest
from vibroimpact.config.yaml_file import read_yaml
from vibroimpact.io.records import RecordError, read_table
from vibroimpact.study.equivalent_table import DIGEST_COLUMN, equivalent_rows
from vibroimpact.study.own_results import other_configuration
from vibroimpact.study.run_files import CONFIG_FILE

from .answer import EquivalentError

SUMMARY, RECOMMENDED = "consistency_summary.csv", "equivalent.csv"


def summary_rows_of(folder: Path, direction: str) -> list[dict[str, Any]]:
    """Return the rows of consistency_summary.csv: per gap, load, group, direction and method.

    direction: that of the force, for a table without the column. A table without `group` holds one
    group, "all"; its one verdict is that on k.

    Raises EquivalentError if the folder holds no such table, or it has no rows.
    """
    path = folder / SUMMARY
    try:
        rows = read_table(path, (DIGEST_COLUMN,))
    except RecordError as error:
        raise EquivalentError(
            f"{path}: is not there: name a finished study with identification, as in"
            " `vibroimpact equivalent gv_local`, or its folder"
        ) from error
    if not rows:
        raise EquivalentError(f"{path}: has no rows: the study identified nothing")
    _require_own(path, rows)
    return [_one_schema(row, direction) for row in rows]


def _require_own(path: Path, rows: list[dict[str, Any]]) -> None:
    """Raise EquivalentError if a table is of another configuration than that of its folder.

    Tables of before the column, and copies without a configuration in their folder, are taken.
    """
    beside = path.parent / CONFIG_FILE
    if DIGEST_COLUMN not in rows[0] or not beside.is_file():
        return
    try:
        current = answer_digest(read_yaml(beside))
    except (ConfigError, LookupError, TypeError) as error:
        raise EquivalentError(f"{beside}: is not the configuration of a run ({error})") from error
    if {row[DIGEST_COLUMN] for row in rows} != {current}:
        raise EquivalentError(other_configuration(path, beside))


def require_tables_of(folder: Path, config: Config, source: str) -> None:
    """Raise EquivalentError if the tables of a folder are of another configuration than one that
    is given. Tables of before the column are taken.

    source: the file of the configuration.
    """
    current = answer_digest(config.model_dump(mode="json"))
    for path in filter(Path.is_file, (folder / SUMMARY, folder / RECOMMENDED)):
        found = {row.get(DIGEST_COLUMN, current) for row in read_table(path, (DIGEST_COLUMN,))}
        if found - {current}:
            raise EquivalentError(
                f"{path}: is of another configuration than {source}: run `snakemake -j2"
                f" --configfile {source}` to the end first, or name the configuration of the study"
            )


def _one_schema(row: dict[str, Any], direction: str) -> dict[str, Any]:
    """Return a row with group, direction, verdict_k, verdict_c, reason and flag."""
    reason, flag = row.get("reason", ""), row.get("flag", "")
    return {
        **row,
        "group": str(row.get("group", "all")),
        "direction": str(row.get("direction", direction)),
        "verdict_k": str(row.get("verdict_k", row.get("verdict", ""))),
        "verdict_c": str(row.get("verdict_c", "")),
        "reason": reason if isinstance(reason, str) else "",
        "flag": flag if isinstance(flag, str) else "",
    }


def recommended_rows_of(
    folder: Path, summary: list[dict[str, Any]], direction: str
) -> list[dict[str, Any]]:
    """Return the recommended rows: per gap, load, group and direction.

    Columns: gap_m, load_rms_N, group, direction, flag, k_bound, contact_fraction, and of k and of
    c: value (k, c), low and high (k_low, ...), secant (secant_k, secant_c), agreement and reason
    (agreement_k, reason_k, ...). They are those of equivalent.csv, which is made of the summary
    if the study does not have it.
    """
    path = folder / RECOMMENDED
    rows = equivalent_rows(summary)
    if path.is_file():
        rows = read_table(path, (DIGEST_COLUMN,))
        _require_own(path, rows)
    return [_from_table(row, direction) for row in rows]


def _from_table(row: dict[str, Any], direction: str) -> dict[str, Any]:
    """Return a row of equivalent.csv under the names of recommended_rows_of."""
    place = _one_schema(row, direction)
    values: dict[str, Any] = {
        name: place[name] for name in ("gap_m", "load_rms_N", "group", "direction", "flag")
    }
    values |= {name: _float(row.get(name, np.nan)) for name in ("k_bound", "contact_fraction")}
    for name, unit in (("k", "N_per_m"), ("c", "N_s_per_m")):
        reason = row.get(f"reason_{name}", "")
        values |= {
            name: float(row[f"{name}_{unit}"]),
            f"{name}_low": float(row[f"{name}_low"]),
            f"{name}_high": float(row[f"{name}_high"]),
            f"secant_{name}": _float(row.get(f"secant_{name}_{unit}", np.nan)),
            f"agreement_{name}": str(row.get(f"agreement_{name}", "")),
            f"reason_{name}": reason if isinstance(reason, str) else "",
        }
    return values


def _float(value: Any) -> float:
    """Return a cell as a number, NaN for an empty one."""
    return float(value) if value != "" else np.nan
