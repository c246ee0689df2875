"""Write the estimates of the cases of some loads, and the curves behind them."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import identify

run_job(identify.make, snakemake)
