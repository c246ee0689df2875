"""Choose the pairs of effects to simulate, where one effect leaves something."""

from vibroimpact.discrepancy.jobs import pairs
from vibroimpact.discrepancy.run import Run
from vibroimpact.job_log import redirect_output
from vibroimpact.records import read_json

redirect_output(snakemake.log[0])
run = Run.opened(snakemake)
pairs(run, snakemake.input.finalists, read_json(snakemake.input.screening), snakemake.output.pairs)
