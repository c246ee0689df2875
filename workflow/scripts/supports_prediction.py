"""Write what linear supports predict of the study: one k and c for all, and each its own."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import supports_prediction

run_job(supports_prediction.make, snakemake)
