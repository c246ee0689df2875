"""Compare the verdicts of a suite with those of the plain suite of the same seed."""

from pathlib import Path

from vibroimpact.acceptance.verdict_agreement import agreement, differences
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table

redirect_output(snakemake.log[0])
rows = differences(
    Path(snakemake.input.plain[0]).parents[1],
    Path(snakemake.input.other[0]).parents[1],
    snakemake.params.campaigns,
)
write_table(rows, snakemake.output.campaigns)
write_table(agreement(rows), snakemake.output.rates)
for row in agreement(rows):
    print(
        f"{row['quantity']}: {row['rate']:.2f} ({row['low']:.2f} to {row['high']:.2f}) of"
        f" {row['campaigns']} campaigns"
    )
