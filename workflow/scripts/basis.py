"""Build and write the reduced model, its accuracy, and what each family of its basis brings."""

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_table
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.basis_accuracy import basis_frequency_errors, require_complete
from vibroimpact.reduction.model_accuracy import (
    COLUMNS,
    mesh_warnings,
    model_accuracy,
    require_accurate,
)
from vibroimpact.reduction.model_file import write_model
from vibroimpact.reduction.reduced_model import build_model

redirect_output(snakemake.log[0])
config = StageSettings(snakemake.params.config)
model = build_model(config)
accuracy = model_accuracy(config)
require_accurate(accuracy)
quality = basis_frequency_errors(config)
require_complete(quality, config.basis)
print(f"{model.modes} modes; residuals of the initial state: {model.initial_residual.tolist()}")
for sentence in mesh_warnings(accuracy):
    print(f"warning: {sentence}")
write_model(
    model,
    snakemake.output.model,
    file_attributes(snakemake.params.config, snakemake.params.library),
)
write_table(accuracy, snakemake.output.accuracy, COLUMNS)
write_table(quality, snakemake.output.quality)
print(Stopwatch().line())
