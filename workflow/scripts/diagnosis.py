"""Say what a model lacks, in one job."""

import os
from pathlib import Path

# Before numpy is imported: threads are for runs, not for linear algebra.
os.environ |= {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}

from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.diagnose import run_diagnosis, write_diagnosis
from vibroimpact.job_log import redirect_output
from vibroimpact.provenance import verdict_origin

redirect_output(snakemake.log[0])
values, campaign = snakemake.params.config, str(snakemake.input.campaign)
diagnosis = run_diagnosis(
    campaign,
    check_config(values, "model"),
    snakemake.params.effort,
    snakemake.threads,
    verdict_origin(values, campaign, None),
    print,
)
write_diagnosis(diagnosis, Path(snakemake.output.verdict).parent)
