"""The coefficients of the Silverbox beside the published ones."""

import sys

from vibroimpact.completion.published import silverbox_table
from vibroimpact.completion.store import read_values
from vibroimpact.records import write_table

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
rows = silverbox_table(read_values(snakemake.input.verdict), read_values(snakemake.input.completed))
write_table(rows, snakemake.output.table)
