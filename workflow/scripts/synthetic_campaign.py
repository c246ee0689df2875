"""Simulate the stand-in for a measured campaign and write it by the campaign contract."""

import sys

from vibroimpact.campaign import write_campaign
from vibroimpact.provenance import origin
from vibroimpact.records import read_model
from vibroimpact.settings import Settings
from vibroimpact.stopwatch import Stopwatch
from vibroimpact.synthetic_campaign import synthetic_campaign

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, stopwatch = Settings(snakemake.params.config), Stopwatch()
campaign = synthetic_campaign(config, read_model(snakemake.input.model), snakemake.params.loads, stopwatch)
write_campaign(campaign.assign_attrs(origin(snakemake.params.config, snakemake.input.library)), snakemake.output.campaign)
print(f"{snakemake.output.campaign} written, loads {snakemake.params.loads} N RMS")
print(stopwatch.line())
