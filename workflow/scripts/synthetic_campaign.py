"""Simulate the stand-in for a measured campaign and write it as a campaign file."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import synthetic_campaign

run_job(synthetic_campaign.make, snakemake)
