"""Draw the figures of the model."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import figures_model

run_job(figures_model.make, snakemake)
