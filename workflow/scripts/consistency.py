"""Gather the estimates of all cases into the consistency tables."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import consistency

run_job(consistency.make, snakemake)
