"""Draw the figures of a diagnosis and write its page."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import discrepancy_report

run_job(discrepancy_report.make, snakemake)
