"""Check a campaign and read its lowest record against the model."""

from vibroimpact.config.reading import check_config
from vibroimpact.discrepancy.cost import job_cost
from vibroimpact.discrepancy.prepared import prepare
from vibroimpact.job_log import redirect_output

redirect_output(snakemake.log[0])
config = check_config(snakemake.params.config, "model")
with job_cost(snakemake.output.prepared, "prepare", begun=0.0):
    prepared = prepare(
        config,
        snakemake.input.campaign,
        asked_s=snakemake.params.compared_s,
        draw=snakemake.params.draw,
    )
    prepared.write(snakemake.output.prepared)
print(prepared.refusal or f"adopted: {prepared.adopted}")
