"""Poles and shapes of the F-16 levels."""

import sys

from vibroimpact.f16 import pole_table
from vibroimpact.records import write_table

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
rows = pole_table(snakemake.input.records)
write_table(rows, snakemake.output.poles)
print(f"{len(rows)} poles and shapes")
