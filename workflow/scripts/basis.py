"""Write the reduced model, its accuracy, and the contribution of each family of its basis."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import basis

run_job(basis.make, snakemake)
