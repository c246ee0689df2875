"""Response statistics of impacting runs along one axis."""

import sys

from vibroimpact.config import check_config
from vibroimpact.records import write_table
from vibroimpact.validation.convergence_runs import run_rows

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
rows = run_rows(check_config(snakemake.params.config, "the study's configuration"), snakemake.wildcards.axis)
write_table(rows, snakemake.output.table)
print(f"{len(rows)} runs along {snakemake.wildcards.axis}")
