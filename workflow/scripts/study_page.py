"""Write the page of a study."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import study_page

run_job(study_page.make, snakemake)
