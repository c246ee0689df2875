"""Simulate a candidate at its first parameters."""

from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.cost import job_cost
from vibroimpact.discrepancy.jobs import candidate_path
from vibroimpact.discrepancy.run import Run
from vibroimpact.discrepancy.store import save_empty
from vibroimpact.job_log import redirect_output

redirect_output(snakemake.log[0])
run = Run.opened(snakemake)
with job_cost(snakemake.output.path, "candidates", begun=0.0):
    if run.refused:
        save_empty(snakemake.output.path)
    else:
        candidate_path(run, candidate_named(snakemake.wildcards.candidate), snakemake.output.path)
