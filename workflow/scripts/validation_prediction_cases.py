"""Cases of the prediction: the study's loads left out, other gaps and loads, or a second tube."""

import sys
from pathlib import Path

from vibroimpact.config import check_config, read_yaml
from vibroimpact.records import read_model, write_table
from vibroimpact.validation import prediction_runs as runs

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
study, folder = check_config(snakemake.params.config, "the study's configuration"), Path(snakemake.input.model).parent
model = read_model(snakemake.input.model)
rows = runs.case_rows(snakemake.wildcards.cases, study, model, folder, read_yaml(snakemake.input.second))
write_table(rows, snakemake.output.table)
