"""A second effect beside the best candidate of a completion, fitted and tried."""

import sys

from vibroimpact.campaign import read_campaign
from vibroimpact.completion.candidate import run_addition
from vibroimpact.completion.store import read_values, write_values
from vibroimpact.completion.study import study_of

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
campaign = read_campaign(snakemake.input.campaign)
study = study_of(snakemake.wildcards.structure, read_values(snakemake.input.study) if snakemake.input.study else None)
linear, singles = read_values(snakemake.input.linear), [read_values(path) for path in snakemake.input.singles]
write_values(run_addition(campaign, study, linear, snakemake.wildcards.law, singles), snakemake.output.candidate)
