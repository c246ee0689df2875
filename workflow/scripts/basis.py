"""Build and write the reduced model and its quality report."""

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.job_log import redirect_output
from vibroimpact.provenance import file_attributes
from vibroimpact.records import write_table
from vibroimpact.reduction.basis_accuracy import basis_frequency_errors
from vibroimpact.reduction.model_file import write_model
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.stopwatch import Stopwatch

redirect_output(snakemake.log[0])
config = StageSettings(snakemake.params.config)
model = build_model(config)
print(f"{model.modes} modes; residuals of the initial state: {model.initial_residual.tolist()}")
write_model(
    model,
    snakemake.output.model,
    file_attributes(snakemake.params.config, snakemake.params.library),
)
write_table(basis_frequency_errors(config), snakemake.output.quality)
print(Stopwatch().line())
