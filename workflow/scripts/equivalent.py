"""Identify the equivalent supports of a measured tube: tables, figures and page."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import equivalent

run_job(equivalent.make, snakemake)
