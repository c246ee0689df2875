"""Simulate the cases of some loads: their records and spectra, without time series."""

from vibroimpact.io.job_log import run_job
from vibroimpact.stages import simulate_to_spectra

run_job(simulate_to_spectra.make, snakemake)
