"""Sum the benchmark files and logs of a study into a table and a figure."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import timing

run_job(timing.make, snakemake)
