"""The files of a measured tube, named as those of a study, so that the same commands read them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.io.records import write_record, write_table
from vibroimpact.reduction.model_file import write_model
from vibroimpact.study.equivalent_table import DIGEST_COLUMN

from .equivalent_of import LOAD, RESPONSE, MeasuredSupports, Rows


def write_measured(
    found: MeasuredSupports, folder: str | Path, attributes: Mapping[str, Any], digest: str
) -> None:
    """Write equivalent.csv, consistency.csv, consistency_summary.csv, .nc and model.nc.

    attributes: of the netCDF files, see provenance.file_attributes.
    digest: answer_digest of the configuration of the tube.

    If no record has a load, its columns are NaN and response_rms_m (m) stands behind them.
    """
    folder = Path(folder)
    tables = {
        "equivalent": found.equivalent,
        "consistency_summary": found.summary,
        "consistency": _with_records(found),
    }
    for name, rows in tables.items():
        own = [row | {DIGEST_COLUMN: digest} for row in _levels(rows, found.levels)]
        write_table(own, folder / f"{name}.csv")
    write_record(found.to_dataset().assign_attrs(attributes), folder / "consistency.nc")
    write_model(found.model, folder / "model.nc", dict(attributes))


def _with_records(found: MeasuredSupports) -> Rows:
    """Return the rows of consistency.csv with the names of their records."""
    names = {(case.gap_m, case.load_rms_N, case.seed): name for case, name in found.records.items()}
    return [
        {**row, "record": names[row["gap_m"], row["load_rms_N"], row["seed"]]} for row in found.rows
    ]


def _levels(rows: Rows, levels: str) -> Rows:
    """Return rows with the level in its own column."""
    if levels == LOAD:
        return rows
    unknown = {"load_rms_N": np.nan, "load_over_gap": np.nan}
    return [{**row, RESPONSE: row["load_rms_N"], **unknown} for row in rows]
