"""Write the estimates of the cases of some loads, and the curves behind them."""

from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.identify.estimate import table_rows
from vibroimpact.identify.identify_case import RECORD_READ, SPECTRA_READ, identify_case
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_record, write_table
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.case_files import read_case


def make(given: Any, made: Any, params: Any) -> Stopwatch:
    """given: model; records and spectra of the cases. made: tables (.csv) and curves (.nc) of the
    cases. params: config, library.
    """
    config = StageSettings(params.config)
    model = read_model(given.model)
    stopwatch = Stopwatch()
    source = file_attributes(params.config, params.library)
    for record_path, spectra_path, table_path, curves_path in zip(
        given.records, given.spectra, made.tables, made.curves, strict=True
    ):
        record = read_case(record_path, RECORD_READ)
        spectra = read_case(spectra_path, SPECTRA_READ)
        estimates, curves = stopwatch.time(
            "identification", identify_case, config, model, record, spectra
        )
        write_table(table_rows(estimates, record.attrs), table_path)
        write_record(curves.assign_attrs(record.attrs | source), curves_path)
        print(
            record.attrs["case"],
            *(f"{item.method}: {item.k:.3g} N/m {item.quality} {item.note}" for item in estimates),
            sep="\n  ",
        )
    return stopwatch
