"""Gather the statistics of all cases into one table."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import statistics

run_job(statistics.make, snakemake)
