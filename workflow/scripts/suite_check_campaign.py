"""Make one of the sealed campaigns of the check and judge it quickly."""

from pathlib import Path
from tempfile import TemporaryDirectory

from vibroimpact.acceptance.quick_check import CHECKS, COMPARED_S, SECONDS, SEED
from vibroimpact.discrepancy.whole import run_campaign
from vibroimpact.job_log import redirect_output
from vibroimpact_truth.campaign import LEVELS, Plan, make_campaign

redirect_output(snakemake.log[0])
name, verdict = snakemake.wildcards.check, Path(snakemake.output.verdict)
plan = Plan((SEED, list(CHECKS).index(name)), CHECKS[name].hidden, levels=LEVELS, duration=SECONDS)
with TemporaryDirectory(dir=verdict.parent) as work:
    make_campaign(plan, Path(work, "campaign.nc"), Path(work, "truth.json"), False)
    run_campaign(
        CHECKS[name].values(snakemake.params.config),
        Path(work, "campaign.nc"),
        work,
        {},
        longest_s=COMPARED_S,
        quick=True,
    )
    Path(work, "verdict.json").rename(verdict)
