"""The table that tells when the equivalent linear model may be used, and its figures."""

import sys
from pathlib import Path

from vibroimpact.figures.validation_prediction import prediction
from vibroimpact.records import read_table, write_table
from vibroimpact.validation.prediction import summary_rows

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
rows = [row for path in snakemake.input.tables for row in read_table(path)]
write_table(rows, snakemake.output.table)
write_table(summary_rows(rows), snakemake.output.summary)
for law in ("load / gap", "load / gap, input gain"):
    prediction(rows, law).save(Path(snakemake.output.figures[0]).parent)
print(f"{len(rows)} predictions")
