"""Choose the pairs of effects to simulate, where one effect leaves something."""

import sys

from vibroimpact.discrepancy.jobs import pairs, read_json
from vibroimpact.discrepancy.run import Run

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
run = Run.opened(snakemake)
pairs(run, snakemake.input.finalists, read_json(snakemake.input.screening), snakemake.output.pairs)
