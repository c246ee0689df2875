"""A second effect beside the best candidate of a completion, fitted and tried."""

from vibroimpact.campaign.file import read_campaign
from vibroimpact.completion.candidate import run_addition
from vibroimpact.completion.store import read_values, write_values
from vibroimpact.completion.study import study_of
from vibroimpact.job_log import redirect_output
from vibroimpact.run_cost import job_cost

redirect_output(snakemake.log[0])
campaign = read_campaign(snakemake.input.campaign)
study = study_of(read_values(snakemake.input.study))
linear = read_values(snakemake.input.linear)
singles = [read_values(path) for path in snakemake.input.singles]
with job_cost(snakemake.output.candidate, "additions", begun=0.0):
    write_values(
        run_addition(campaign, study, linear, snakemake.params.law, singles),
        snakemake.output.candidate,
    )
