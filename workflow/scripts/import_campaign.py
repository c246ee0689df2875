"""Make a campaign of a folder of measurements, check it and draw it."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import import_campaign

run_job(import_campaign.make, snakemake)
