"""The records of a measured structure as a campaign."""

from vibroimpact.campaign.file import write_campaign
from vibroimpact.completion.benchmark_records import benchmark_campaign
from vibroimpact.job_log import redirect_output

redirect_output(snakemake.log[0])
campaign = benchmark_campaign(snakemake.wildcards.structure, snakemake.input.records)
write_campaign(campaign, snakemake.output.campaign)
print(f"{campaign.sizes['record']} records of {campaign.sizes['channel']} channels")
