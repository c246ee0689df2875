"""One table of the statistics of all cases."""

import sys

from vibroimpact.records import read_record, write_table
from vibroimpact.statistics_table import statistics_rows
from vibroimpact.stopwatch import Stopwatch

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
rows = [row for path in snakemake.input.records for row in statistics_rows(read_record(path))]
write_table(rows, snakemake.output.table)
print(f"{snakemake.params.config['study']}: {len(rows)} rows from {len(snakemake.input.records)} cases")
print(Stopwatch().line())
