"""Simulate the cases of some loads: their records and, if wanted, their time series."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import simulate

run_job(simulate.make, snakemake)
