"""The records of a measured structure as a campaign."""

import sys

from vibroimpact.campaign import write_campaign
from vibroimpact.completion.benchmark_records import benchmark_campaign

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
campaign = benchmark_campaign(snakemake.wildcards.structure, snakemake.input.records)
write_campaign(campaign, snakemake.output.campaign)
print(f"{campaign.sizes['record']} records of {campaign.sizes['channel']} channels")
