"""Refine a finalist by direct simulation."""

import sys

from vibroimpact.discrepancy.jobs import finalist, read_json, rival_of
from vibroimpact.discrepancy.run import Run

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
run = Run.opened(snakemake)
name = snakemake.wildcards.candidate
screened = read_json(snakemake.input.screening)
finalist(run, name, screened["finalists"][name], snakemake.output.finalist, rival=rival_of(name, screened))
