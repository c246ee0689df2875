"""Simulate a candidate at its first parameters."""

import sys

from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.jobs import candidate_path
from vibroimpact.discrepancy.run import Run
from vibroimpact.discrepancy.store import save_empty

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
run = Run.opened(snakemake)
if run.refused:
    save_empty(snakemake.output.path)
else:
    candidate_path(run, candidate_named(snakemake.wildcards.candidate), snakemake.output.path)
