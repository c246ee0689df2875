"""Simulate all candidates on a campaign with nothing hidden; all campaigns share the results."""

import pickle
from pathlib import Path

from vibroimpact.acceptance.shards import suite_of
from vibroimpact.discrepancy.whole import run_campaign
from vibroimpact.job_log import redirect_output
from vibroimpact.whole_file import whole_file
from vibroimpact_truth.campaign import LEVELS, Plan, make_campaign

redirect_output(snakemake.log[0])
folder, tables = Path(snakemake.output.done).parent, {}
suite = suite_of(snakemake.wildcards.suite)
make_campaign(
    Plan(
        (0, 0),
        (),
        "null",
        levels=LEVELS,
        duration=float(suite["seconds"]),
        gain_scatter=0.0,
        frequency_scatter=0.0,
        damping_scatter=0.0,
    ),
    snakemake.output.campaign,
    folder / "truth.json",
    False,
)
run_campaign(
    snakemake.params.config,
    snakemake.output.campaign,
    folder,
    {},
    tables=tables,
    for_all=True,
    draw=suite["draw"],
    workers=snakemake.threads,
)
with whole_file(folder / "tables.pickle") as temporary:
    temporary.write_bytes(pickle.dumps(tables))
