"""The verdict of a completion, the prediction of every level and the completed model as a configuration."""

import sys

from vibroimpact.campaign import read_campaign
from vibroimpact.completion.conclude import conclude
from vibroimpact.completion.store import read_values, write_values
from vibroimpact.completion.study import STUDIES
from vibroimpact.completion.updated_model import write_configuration
from vibroimpact.records import write_table

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
campaign, study = read_campaign(snakemake.input.campaign), STUDIES[snakemake.wildcards.structure]
singles, additions = ([read_values(path) for path in paths] for paths in (snakemake.input.singles, snakemake.input.additions))
verdict, rows, completed = conclude(campaign, study, read_values(snakemake.input.linear), singles, additions)
write_table(rows, snakemake.output.prediction)
write_values(completed, snakemake.output.completed)
write_configuration(completed, campaign, study, snakemake.output.model)
write_values(verdict, snakemake.output.verdict)
