"""The linear models of a measured structure, and its equivalent support against level."""

from vibroimpact.campaign.file import read_campaign
from vibroimpact.completion.levels import levels_of
from vibroimpact.completion.linear_models import linear_models
from vibroimpact.completion.mounting import COLUMNS, mounting_table
from vibroimpact.completion.store import write_values
from vibroimpact.completion.study import STUDIES
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table

redirect_output(snakemake.log[0])
campaign, study = read_campaign(snakemake.input.campaign), STUDIES[snakemake.wildcards.structure]
linear = linear_models(campaign, study)
write_values(linear, snakemake.output.linear)
write_table(
    mounting_table(levels_of(campaign)[0], study, linear)[0], snakemake.output.mounting, COLUMNS
)
