"""Refine a pair of effects by direct simulation."""

import sys

from vibroimpact.discrepancy.jobs import finalist, read_json
from vibroimpact.discrepancy.run import Run

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
finalist(Run.opened(snakemake), snakemake.wildcards.pair, read_json(snakemake.input.pairs), snakemake.output.pair)
