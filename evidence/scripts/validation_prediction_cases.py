"""Cases of the prediction: the study's loads left out, other gaps and loads, or a second tube."""

from pathlib import Path

from evidence.validation.prediction import runs
from vibroimpact.config.reading import check_config, read_yaml
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table
from vibroimpact.reduction.model_file import read_model

redirect_output(snakemake.log[0])
study = check_config(snakemake.params.config, "the study's configuration")
folder = Path(snakemake.input.model).parent
model = read_model(snakemake.input.model)
rows = runs.case_rows(
    snakemake.wildcards.cases, study, model, folder, read_yaml(snakemake.input.second)
)
write_table(rows, snakemake.output.table)
