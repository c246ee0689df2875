"""Draw the figures of the responses."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import figures_response

run_job(figures_response.make, snakemake)
