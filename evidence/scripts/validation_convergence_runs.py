"""Response statistics of impacting runs along one axis."""

from evidence.validation.convergence.runs import run_rows
from vibroimpact.config.reading import check_config
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table

redirect_output(snakemake.log[0])
rows = run_rows(
    check_config(snakemake.params.config, "the study's configuration"), snakemake.wildcards.axis
)
write_table(rows, snakemake.output.table)
print(f"{len(rows)} runs along {snakemake.wildcards.axis}")
