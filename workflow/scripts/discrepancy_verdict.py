"""Decide, verify on fresh seeds, and write verdict, maps, ranking and the completed model."""

from vibroimpact.discrepancy.conclusion import conclude
from vibroimpact.discrepancy.cost import Meter
from vibroimpact.discrepancy.run import Run
from vibroimpact.job_log import redirect_output
from vibroimpact.provenance import verdict_origin
from vibroimpact.records import read_json

redirect_output(snakemake.log[0])
run = Run.opened(snakemake)
seed = f"{run.config.seed}, draw {run.prepared.draw}"
source = verdict_origin(snakemake.params.config, run.campaign, seed)
files = [*snakemake.input.finalists, *snakemake.input.pairs]
screening = read_json(snakemake.input.screening)
conclude(run, screening, files, source, Meter("verdict", begun=0.0))
