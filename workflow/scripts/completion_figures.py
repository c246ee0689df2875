"""The figures of a completion."""

from pathlib import Path

from vibroimpact.campaign.file import read_campaign
from vibroimpact.completion.store import read_values
from vibroimpact.completion.study import STUDIES
from vibroimpact.figures.discrepancy import completion
from vibroimpact.job_log import redirect_output
from vibroimpact.records import read_table

redirect_output(snakemake.log[0])
campaign, study = read_campaign(snakemake.input.campaign), STUDIES[snakemake.wildcards.structure]
linear, completed, verdict = (
    read_values(path)
    for path in (snakemake.input.linear, snakemake.input.completed, snakemake.input.verdict)
)
mounting, prediction = read_table(snakemake.input.mounting), read_table(snakemake.input.prediction)
for sheet in completion.sheets(campaign, study, linear, completed, verdict, mounting, prediction):
    sheet.save(Path(snakemake.output.figures[0]).parent)
