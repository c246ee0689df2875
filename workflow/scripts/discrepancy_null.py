"""Simulate a part of the seeds of the bare model."""

from vibroimpact.discrepancy.cost import job_cost
from vibroimpact.discrepancy.jobs import null_part
from vibroimpact.discrepancy.run import Run
from vibroimpact.discrepancy.store import save_empty
from vibroimpact.job_log import redirect_output

redirect_output(snakemake.log[0])
run = Run.opened(snakemake)
with job_cost(snakemake.output.null, "null", begun=0.0):
    if run.refused:
        save_empty(snakemake.output.null)
    else:
        null_part(run, int(snakemake.wildcards.part), snakemake.output.null)
