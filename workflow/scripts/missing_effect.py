"""Name the effect that a model lacks, in one job."""

import os
from pathlib import Path

# Before numpy is imported: threads are for runs, not for linear algebra.
os.environ |= {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}

from vibroimpact.config.reading import check_config
from vibroimpact.job_log import redirect_output
from vibroimpact.missing_effect.engine import Engine
from vibroimpact.provenance import verdict_origin

redirect_output(snakemake.log[0])
values, campaign = snakemake.params.config, str(snakemake.input.campaign)
draw = snakemake.params.draw
engine = Engine(
    check_config(values, "model"),
    campaign,
    Path(snakemake.output.verdict).parent,
    snakemake.params.effort,
    draw,
    snakemake.threads,
)
engine.run(verdict_origin(values, campaign, f"{values['seed']}, draw {draw}"))
