"""Simulate all cases of one load and write their records and spectra; their time series are never written."""

import sys

from vibroimpact.cases import cases_of_load
from vibroimpact.provenance import origin
from vibroimpact.records import read_model, write_record
from vibroimpact.settings import Settings
from vibroimpact.simulate import simulate_cases
from vibroimpact.spectra_files import spectra_files
from vibroimpact.stopwatch import Stopwatch

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, model = Settings(snakemake.params.config), read_model(snakemake.input.model)
cases, source, stopwatch = cases_of_load(config.grid, float(snakemake.wildcards.load)), origin(snakemake.params.config, snakemake.input.library), Stopwatch()
records, spectra = dict(zip(cases, snakemake.output.records)), dict(zip(cases, snakemake.output.spectra))
for case, record in simulate_cases(config, model, cases, spectra_files(config, model, spectra, source, stopwatch), stopwatch):
    write_record(record.assign_attrs(record.attrs | source), records[case])
print(stopwatch.line())
