"""Hold the verdicts of a suite against those of the plain one of the same seed."""

import sys
from pathlib import Path

from vibroimpact.discrepancy.suite_difference import agreement, differences
from vibroimpact.records import write_table

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
rows = differences(Path(snakemake.input.plain[0]).parents[1], Path(snakemake.input.other[0]).parents[1], snakemake.params.campaigns)
write_table(rows, snakemake.output.campaigns)
write_table(agreement(rows), snakemake.output.rates)
for row in agreement(rows):
    print(f"{row['quantity']}: {row['rate']:.2f} ({row['low']:.2f} to {row['high']:.2f}) of {row['campaigns']} campaigns")
