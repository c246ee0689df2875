"""Decide, verify on fresh seeds, and write verdict, maps, ranking and the completed model."""

from vibroimpact.discrepancy.conclusion import conclude
from vibroimpact.discrepancy.run import Run
from vibroimpact.job_log import redirect_output
from vibroimpact.provenance import origin
from vibroimpact.records import read_json

redirect_output(snakemake.log[0])
run = Run.opened(snakemake)
source = origin(snakemake.params.config, snakemake.params.library)
files = [*snakemake.input.finalists, *snakemake.input.pairs]
conclude(run, read_json(snakemake.input.screening), files, source)
