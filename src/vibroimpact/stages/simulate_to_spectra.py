"""Simulate the cases of some loads: their records and spectra, without time series."""

from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_record
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.cases import cases_of_files
from vibroimpact.study.own_results import model_attributes
from vibroimpact.study.simulation import simulate_cases
from vibroimpact.study.spectra_writer import spectra_writer


def make(given: Any, made: Any, params: Any) -> Stopwatch:
    """given: model. made: records and spectra of the cases. params: config, library."""
    config, model = StageSettings(params.config), read_model(given.model)
    cases = cases_of_files(made.records)
    source = file_attributes(params.config, params.library) | model_attributes(given.model)
    stopwatch = Stopwatch()
    records = dict(zip(cases, made.records, strict=True))
    spectra = dict(zip(cases, made.spectra, strict=True))
    writer = spectra_writer(config, model, spectra, source, stopwatch)
    for case, record in simulate_cases(config, model, cases, writer, stopwatch):
        write_record(record.assign_attrs(record.attrs | source), records[case])
    return stopwatch
