"""Make a sealed campaign of the suite, run it, and write its verdict and its truth."""

import pickle
from pathlib import Path

from vibroimpact.acceptance.sealed_run import left_out, run_sealed
from vibroimpact.acceptance.shards import suite_of
from vibroimpact.job_log import redirect_output
from vibroimpact_truth.campaign import LEVELS, make_campaign
from vibroimpact_truth.draw import draw_plans

redirect_output(snakemake.log[0])
number, bank = int(snakemake.wildcards.number), Path(snakemake.input.bank).parent
suite = suite_of(snakemake.wildcards.suite)
plans = draw_plans(suite["seed"], number + 1, levels=LEVELS, duration=float(suite["seconds"]))
plan = plans[number]
folder = Path(snakemake.output.verdict).parent
make_campaign(plan, folder / "campaign.nc", snakemake.output.truth, twin=False)
run_sealed(
    snakemake.params.config,
    folder,
    bank,
    pickle.loads((bank / "tables.pickle").read_bytes()),
    left_out(plan.effects, plan.arm),
    suite["draw"],
)
