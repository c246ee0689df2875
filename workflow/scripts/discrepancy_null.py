"""Simulate a part of the seeds of the bare model."""

import sys

from vibroimpact.discrepancy.jobs import null_part
from vibroimpact.discrepancy.run import Run
from vibroimpact.discrepancy.store import save_empty

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
run = Run.opened(snakemake)
if run.refused:
    save_empty(snakemake.output.null)
else:
    null_part(run, int(snakemake.wildcards.part), snakemake.output.null)
