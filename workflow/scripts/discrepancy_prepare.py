"""Check a campaign and read its lowest record against the model."""

import sys

from vibroimpact.config import check_config
from vibroimpact.discrepancy.prepared import prepare

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config = check_config(snakemake.params.config, "model")
prepared = prepare(config, snakemake.input.campaign, asked_s=snakemake.params.compared_s, draw=snakemake.params.draw)
prepared.write(snakemake.output.prepared)
print(prepared.refusal or f"adopted: {prepared.adopted}")
