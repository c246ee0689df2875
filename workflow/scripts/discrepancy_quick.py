"""A whole discrepancy run in one job, with short records and fewer parameters."""

import os
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

# Before numpy is imported: this job forks one process per core.
os.environ |= {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}

from vibroimpact.discrepancy.dag import QUICK_S
from vibroimpact.discrepancy.whole import run_campaign
from vibroimpact.job_log import redirect_output
from vibroimpact.provenance import verdict_origin

redirect_output(snakemake.log[0])
config, campaign = snakemake.params.config, snakemake.input.campaign
source = verdict_origin(config, campaign, f"{config['seed']}, draw 0")
with TemporaryDirectory(dir=Path(snakemake.output.verdict).parent) as work:
    run_campaign(
        config,
        campaign,
        work,
        source,
        longest_s=QUICK_S,
        quick=True,
        workers=snakemake.threads,
    )
    for made in snakemake.output:
        shutil.move(Path(work, Path(made).name), made)
