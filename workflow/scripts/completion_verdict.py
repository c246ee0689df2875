"""The verdict of a completion, the prediction of every level and the completed model as a
configuration.
"""

from vibroimpact.campaign.file import read_campaign
from vibroimpact.completion.conclude import conclude
from vibroimpact.completion.store import read_values, write_values
from vibroimpact.completion.study import STUDIES
from vibroimpact.completion.updated_model import write_configuration
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table
from vibroimpact.verdict.file import write_verdict

redirect_output(snakemake.log[0])
campaign, study = read_campaign(snakemake.input.campaign), STUDIES[snakemake.wildcards.structure]
singles, additions = (
    [read_values(path) for path in paths]
    for paths in (snakemake.input.singles, snakemake.input.additions)
)
verdict, rows, completed = conclude(
    campaign, study, read_values(snakemake.input.linear), singles, additions
)
write_table(rows, snakemake.output.prediction)
write_values(completed, snakemake.output.completed)
write_configuration(completed, campaign, study, snakemake.output.model)
write_verdict(verdict, snakemake.output.verdict)
