"""Write the reduced model, its accuracy, and what each family of its basis brings."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import basis

run_job(basis.make, snakemake)
