"""Write the spectra of the cases of some loads from their time series."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import spectra

run_job(spectra.make, snakemake)
