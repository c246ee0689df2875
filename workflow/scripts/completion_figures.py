"""The figures of a completion."""

import sys

from pathlib import Path

from vibroimpact.campaign import read_campaign
from vibroimpact.completion.store import read_values
from vibroimpact.completion.study import STUDIES
from vibroimpact.figures import completion
from vibroimpact.records import read_table

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
campaign, study = read_campaign(snakemake.input.campaign), STUDIES[snakemake.wildcards.structure]
linear, completed, verdict = (read_values(path) for path in (snakemake.input.linear, snakemake.input.completed, snakemake.input.verdict))
mounting, prediction = read_table(snakemake.input.mounting), read_table(snakemake.input.prediction)
for sheet in completion.sheets(campaign, study, linear, completed, verdict, mounting, prediction):
    sheet.save(Path(snakemake.output.figures[0]).parent)
