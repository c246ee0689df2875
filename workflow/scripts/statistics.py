"""Gather the statistics of all cases into one table."""

from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.study.case_files import read_case
from vibroimpact.study.statistics_table import statistics_rows

redirect_output(snakemake.log[0])
rows = [row for path in snakemake.input.records for row in statistics_rows(read_case(path))]
write_table(rows, snakemake.output.table)
cases = len(snakemake.input.records)
print(f"{snakemake.params.config['study']}: {len(rows)} rows from {cases} cases")
print(Stopwatch().line())
