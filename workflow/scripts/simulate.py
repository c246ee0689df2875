"""Simulate all cases of one load and write their records, and their time series where they are kept."""

import sys

from vibroimpact.cases import cases_of_load
from vibroimpact.provenance import origin
from vibroimpact.records import read_model
from vibroimpact.series_files import series_files, write_parts
from vibroimpact.settings import Settings
from vibroimpact.simulate import simulate_cases
from vibroimpact.stopwatch import Stopwatch

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, model = Settings(snakemake.params.config), read_model(snakemake.input.model)
cases, source, stopwatch = cases_of_load(config.grid, float(snakemake.wildcards.load)), origin(snakemake.params.config, snakemake.input.library), Stopwatch()
records, series = dict(zip(cases, snakemake.output.records)), dict(zip(cases, snakemake.output.series))
for case, record in simulate_cases(config, model, cases, series_files(config, model, series, source), stopwatch):
    write_parts(record.assign_attrs(record.attrs | source), records[case], series.get(case))
print(stopwatch.line())
