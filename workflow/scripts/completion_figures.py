"""The figures of a completion."""

from pathlib import Path

from vibroimpact.campaign.file import read_campaign
from vibroimpact.completion.store import read_values
from vibroimpact.completion.study import STUDIES
from vibroimpact.figures.discrepancy import completion
from vibroimpact.job_log import redirect_output
from vibroimpact.records import read_table
from vibroimpact.verdict.file import read_verdict

redirect_output(snakemake.log[0])
campaign, study = read_campaign(snakemake.input.campaign), STUDIES[snakemake.wildcards.structure]
linear, completed = map(read_values, (snakemake.input.linear, snakemake.input.completed))
verdict = read_verdict(snakemake.input.verdict)
mounting, prediction = read_table(snakemake.input.mounting), read_table(snakemake.input.prediction)
for sheet in completion.sheets(campaign, study, linear, completed, verdict, mounting, prediction):
    sheet.save(Path(snakemake.output.figures[0]).parent)
