"""Sum the benchmark files and logs of a study into a table and a figure."""

from pathlib import Path

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.figures.study.timing import timing
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table
from vibroimpact.study.timing import study_timing

redirect_output(snakemake.log[0])
rows = study_timing(snakemake.input.benchmarks, snakemake.params.logs)
write_table(rows, snakemake.output.table)
for sheet in timing(StageSettings(snakemake.params.config), rows):
    sheet.save(Path(snakemake.output.figures[0]).parent)
