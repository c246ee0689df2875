"""Refine a finalist by direct simulation."""

from vibroimpact.discrepancy.cost import job_cost
from vibroimpact.discrepancy.jobs import finalist
from vibroimpact.discrepancy.run import Run
from vibroimpact.job_log import redirect_output
from vibroimpact.records import read_json

redirect_output(snakemake.log[0])
with job_cost(snakemake.output.finalist, "finalists", begun=0.0):
    finalist(
        Run.opened(snakemake),
        snakemake.wildcards.candidate,
        read_json(snakemake.input.screening),
        snakemake.output.finalist,
    )
