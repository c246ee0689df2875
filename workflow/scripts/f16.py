"""Poles and shapes of the F-16 levels."""

from vibroimpact.f16 import pole_table
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table

redirect_output(snakemake.log[0])
rows = pole_table(snakemake.input.records)
write_table(rows, snakemake.output.poles)
print(f"{len(rows)} poles and shapes")
