"""Choose the pairs of effects to simulate, where one effect leaves something."""

from vibroimpact.discrepancy.jobs import pairs, read_json
from vibroimpact.discrepancy.run import Run
from vibroimpact.job_log import redirect_output

redirect_output(snakemake.log[0])
run = Run.opened(snakemake)
pairs(run, snakemake.input.finalists, read_json(snakemake.input.screening), snakemake.output.pairs)
