"""The coefficients of the Silverbox beside the published ones."""

from vibroimpact.completion.published import silverbox_table
from vibroimpact.completion.store import read_values
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table

redirect_output(snakemake.log[0])
rows = silverbox_table(read_values(snakemake.input.verdict), read_values(snakemake.input.completed))
write_table(rows, snakemake.output.table)
