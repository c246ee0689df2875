"""Gather the estimates of all cases into the consistency tables."""

from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.identify.linear.support_groups import unreached_supports
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_record, write_table
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.agreement_dataset import consistency_dataset
from vibroimpact.study.case_files import read_estimates
from vibroimpact.study.equivalent_table import DIGEST_COLUMN, EQUIVALENT_COLUMNS, equivalent_rows
from vibroimpact.study.method_agreement import (
    COLLAPSE_COLUMNS,
    collapse_rows,
    consistency_rows,
    summary_rows,
)


def make(given: Any, made: Any, params: Any) -> None:
    """given: model, tables of the cases. made: table, summary, collapse and equivalent (.csv),
    dataset (.nc). params: config, library, digest of all that the numbers depend on.
    """
    config = StageSettings(params.config)
    model = read_model(given.model)
    rows = consistency_rows(read_estimates(given.tables, model, config.identification.groups))
    summary = summary_rows(rows)
    unreached = unreached_supports(model, config.identification.groups)
    for name, table, columns in (
        ("table", rows, ()),
        ("summary", summary, ()),
        ("collapse", collapse_rows(summary), COLLAPSE_COLUMNS),
        ("equivalent", equivalent_rows(summary, unreached), EQUIVALENT_COLUMNS),
    ):
        own = {DIGEST_COLUMN: params.digest}
        write_table([row | own for row in table], getattr(made, name), (*columns, *own))
    dataset = consistency_dataset(rows, summary)
    write_record(dataset.assign_attrs(file_attributes(params.config, params.library)), made.dataset)
    print(f"{len(rows)} estimates")
