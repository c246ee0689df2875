"""Rank all candidates and choose those to simulate directly."""

import sys

from vibroimpact.discrepancy.jobs import screening
from vibroimpact.discrepancy.run import Run

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
run = Run.opened(snakemake)
screening(run, snakemake.output.screening)
