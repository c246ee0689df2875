"""Gather the estimates of all cases into the consistency tables."""

from vibroimpact.job_log import redirect_output
from vibroimpact.provenance import file_attributes
from vibroimpact.records import read_table, write_record, write_table
from vibroimpact.stopwatch import Stopwatch
from vibroimpact.study.method_agreement import (
    COLLAPSE_COLUMNS,
    collapse_rows,
    consistency_dataset,
    consistency_rows,
    summary_rows,
)

redirect_output(snakemake.log[0])
rows = consistency_rows([read_table(path) for path in snakemake.input.tables])
summary = summary_rows(rows)
write_table(rows, snakemake.output.table)
write_table(summary, snakemake.output.summary)
write_table(collapse_rows(summary), snakemake.output.collapse, COLLAPSE_COLUMNS)
dataset = consistency_dataset(rows, summary)
write_record(
    dataset.assign_attrs(file_attributes(snakemake.params.config, snakemake.input.library)),
    snakemake.output.dataset,
)
print(f"{len(rows)} estimates")
print(Stopwatch().line())
