"""Write the reduced model, its accuracy, and the contribution of each family of its basis."""

from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_table
from vibroimpact.reduction.basis_accuracy import basis_frequency_errors, require_complete
from vibroimpact.reduction.model_accuracy import (
    COLUMNS,
    mesh_warnings,
    model_accuracy,
    require_accurate,
)
from vibroimpact.reduction.model_file import write_model
from vibroimpact.reduction.reduced_model import build_model


def make(given: Any, made: Any, params: Any) -> None:
    """made: model (.nc), accuracy and quality (.csv). params: config, library.

    Raises ModelAccuracyError for a mesh too coarse, ValueError for a basis that is not complete.
    """
    config = StageSettings(params.config)
    model = build_model(config)
    accuracy = model_accuracy(config)
    require_accurate(accuracy)
    quality = basis_frequency_errors(config)
    require_complete(quality, config.basis)
    print(f"{model.modes} modes; residuals of the initial state: {model.initial_residual.tolist()}")
    for sentence in mesh_warnings(accuracy):
        print(f"warning: {sentence}")
    write_model(model, made.model, file_attributes(params.config, params.library))
    write_table(accuracy, made.accuracy, COLUMNS)
    write_table(quality, made.quality)
