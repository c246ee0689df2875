"""Rank all candidates and choose those to simulate directly."""

from vibroimpact.discrepancy.cost import job_cost
from vibroimpact.discrepancy.jobs import screening
from vibroimpact.discrepancy.run import Run
from vibroimpact.job_log import redirect_output

redirect_output(snakemake.log[0])
run = Run.opened(snakemake)
with job_cost(snakemake.output.screening, "screening", begun=0.0):
    screening(run, snakemake.output.screening)
