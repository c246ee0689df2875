"""Write the predictions of linear supports for the study: one k and c for all, and each its own."""

from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.equivalent_support import supports_prediction as supports
from vibroimpact.identify.identify_case import RECORD_READ, SPECTRA_READ
from vibroimpact.identify.linear.support_groups import ALL
from vibroimpact.io.records import read_table, write_table
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.case_files import read_case
from vibroimpact.study.equivalent_table import EQUIVALENT_COLUMNS


def make(given: Any, made: Any, params: Any) -> None:
    """given: model, equivalent, records, spectra. made: table, one. params: config."""
    settings, model = params.config, read_model(given.model)
    of_all = {**settings, "identification": {**settings["identification"], "groups": ALL}}
    records = [read_case(path, (*RECORD_READ, *supports.RECORD_READ)) for path in given.records]
    spectra = [read_case(path, (*SPECTRA_READ, *supports.SPECTRA_READ)) for path in given.spectra]
    one = supports.one_for_all(StageSettings(of_all), model, records, spectra)
    equivalent = {supports.ONE: one, supports.EACH: read_table(given.equivalent)}
    rows = supports.supports_prediction_rows(
        StageSettings(settings), model, equivalent, records, spectra
    )
    write_table(one, made.one, EQUIVALENT_COLUMNS)
    write_table(rows, made.table, supports.COLUMNS)
    print(f"{len(rows)} comparisons")
