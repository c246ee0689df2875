"""The table that tells when the equivalent linear model may be used, and its figures."""

from pathlib import Path

from evidence.validation.figures.prediction import prediction
from evidence.validation.prediction.responses import summary_rows
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table, write_table
from vibroimpact.reports.figures.drawing import save_plots

redirect_output(snakemake.log[0])
rows = [row for path in snakemake.input.tables for row in read_table(path)]
write_table(rows, snakemake.output.table)
write_table(summary_rows(rows), snakemake.output.summary)
plots = [prediction(rows, law) for law in ("load / gap", "load / gap, input gain")]
save_plots(plots, Path(snakemake.output.figures[0]).parent)
print(f"{len(rows)} predictions")
