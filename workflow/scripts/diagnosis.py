"""Write the effects that a model lacks of a measured campaign, in one job."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import diagnosis

run_job(diagnosis.make, snakemake, snakemake.threads)
