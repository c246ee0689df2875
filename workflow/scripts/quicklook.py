"""Check a campaign and draw it."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import quicklook

run_job(quicklook.make, snakemake)
