"""Simulate the stand-in for a measured campaign and write it by the campaign contract."""

from vibroimpact.campaign.file import write_campaign
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.synthetic_campaign import synthetic_campaign

redirect_output(snakemake.log[0])
config, stopwatch = StageSettings(snakemake.params.config), Stopwatch()
campaign = synthetic_campaign(
    config, read_model(snakemake.input.model), snakemake.params.loads, stopwatch
)
write_campaign(
    campaign.assign_attrs(file_attributes(snakemake.params.config, snakemake.params.library)),
    snakemake.output.campaign,
)
print(f"{snakemake.output.campaign} written, loads {snakemake.params.loads} N RMS")
print(stopwatch.line())
