"""The law of the equivalent support from the study, and its error on other tubes."""

from pathlib import Path

from evidence.validation.prediction.law_errors import error_rows, measured_law
from evidence.validation.prediction.laws import law_text
from vibroimpact.config.reading import check_config, read_yaml
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table, write_table, write_text
from vibroimpact.reduction.model_file import read_model

redirect_output(snakemake.log[0])
study = check_config(snakemake.params.config, "the study's configuration")
law, rows, origin = measured_law(
    study,
    read_model(snakemake.input.model),
    read_table(snakemake.input.table),
    read_yaml(snakemake.input.tubes),
)
write_table(rows, snakemake.output.errors)
write_text(law_text(law, error_rows(rows), origin), Path(snakemake.output.law))
print(f"{len(law.level)} points, {len(rows)} cases of other tubes")
