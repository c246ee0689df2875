"""Sum the benchmark files and logs of a study into a table and a figure."""

import sys
from pathlib import Path

from vibroimpact.figures.timing import timing
from vibroimpact.records import write_table
from vibroimpact.settings import Settings
from vibroimpact.timing import study_timing

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
rows = study_timing(snakemake.input.benchmarks, snakemake.params.logs)
write_table(rows, snakemake.output.table)
for sheet in timing(Settings(snakemake.params.config), rows):
    sheet.save(Path(snakemake.output.figures[0]).parent)
