"""Simulate the cases of some loads: their records and, if wanted, their time series."""

from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_record
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.cases import cases_of_files
from vibroimpact.study.own_results import model_attributes
from vibroimpact.study.record_variables import split_record
from vibroimpact.study.series_writer import series_writer
from vibroimpact.study.simulation import simulate_cases


def make(given: Any, made: Any, params: Any) -> Stopwatch:
    """given: model. made: records of the cases, series of the cases or none. params: config,
    library.
    """
    config, model = StageSettings(params.config), read_model(given.model)
    cases = cases_of_files(made.records)
    source = file_attributes(params.config, params.library) | model_attributes(given.model)
    stopwatch = Stopwatch()
    records = dict(zip(cases, made.records, strict=False))
    series = dict(zip(cases, made.series, strict=False))
    writer = series_writer(config, model, series, source)
    for case, record in simulate_cases(config, model, cases, writer, stopwatch):
        tallies, traces = split_record(record.assign_attrs(record.attrs | source))
        write_record(tallies, records[case])
        if traces.data_vars:  # every step was recorded
            write_record(traces, series[case])
    return stopwatch
