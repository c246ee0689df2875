"""Say what a model lacks, in one job."""

import os
from pathlib import Path

# Before numpy is imported: threads are for runs, not for linear algebra.
os.environ |= {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}

from vibroimpact.diagnosis.diagnose import run_diagnosis, write_diagnosis
from vibroimpact.diagnosis.identified.structure_file import model_from
from vibroimpact.diagnosis.progress import SoFar
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.provenance import verdict_origin

redirect_output(snakemake.log[0])
values, campaign = snakemake.params.model, str(snakemake.input.campaign)
diagnosis = run_diagnosis(
    campaign,
    model_from(values),
    snakemake.params.effort,
    snakemake.threads,
    verdict_origin(values, campaign, None),
    SoFar(snakemake.params.so_far),
)
write_diagnosis(diagnosis, Path(snakemake.output.verdict).parent)
