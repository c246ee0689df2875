"""Write the spectra of the cases of some loads from their time series."""

from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_record
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.study.case_files import read_case
from vibroimpact.study.case_spectra import case_spectra


def make(given: Any, made: Any, params: Any) -> Stopwatch:
    """given: series of the cases. made: spectra of the cases. params: config, library."""
    config, stopwatch = StageSettings(params.config), Stopwatch()
    for series, path in zip(given.series, made.spectra, strict=True):
        record = read_case(series)
        spectra = stopwatch.time("spectra", case_spectra, config, record)
        write_record(spectra.assign_attrs(file_attributes(params.config, params.library)), path)
        print(f"{path} written")
    return stopwatch
