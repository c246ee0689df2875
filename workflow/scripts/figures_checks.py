"""Draw the figures that compare the methods and check the simulations."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import figures_checks

run_job(figures_checks.make, snakemake)
