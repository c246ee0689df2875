"""Choose the pairs of effects to simulate, where one effect leaves something."""

from vibroimpact.discrepancy.cost import job_cost
from vibroimpact.discrepancy.jobs import pairs
from vibroimpact.discrepancy.run import Run
from vibroimpact.job_log import redirect_output
from vibroimpact.records import read_json

redirect_output(snakemake.log[0])
with job_cost(snakemake.output.pairs, "pairs", begun=0.0):
    pairs(
        Run.opened(snakemake),
        snakemake.input.finalists,
        read_json(snakemake.input.screening),
        snakemake.output.pairs,
    )
