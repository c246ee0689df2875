"""Rank all candidates and choose those to simulate directly."""

from vibroimpact.discrepancy.jobs import screening
from vibroimpact.discrepancy.run import Run
from vibroimpact.job_log import redirect_output

redirect_output(snakemake.log[0])
run = Run.opened(snakemake)
screening(run, snakemake.output.screening)
