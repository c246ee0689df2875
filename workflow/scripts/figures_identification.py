"""Draw the figures of the identifications, for the largest gap."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import figures_identification

run_job(figures_identification.make, snakemake)
