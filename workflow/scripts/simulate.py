"""Simulate all cases of one load and write their records and, if wanted, their time series."""

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.cases import cases_of_files
from vibroimpact.study.own_results import model_attributes
from vibroimpact.study.series_writer import series_writer, write_record_parts
from vibroimpact.study.simulation import simulate_cases

redirect_output(snakemake.log[0])
config, model = StageSettings(snakemake.params.config), read_model(snakemake.input.model)
cases = cases_of_files(snakemake.output.records)
source = file_attributes(snakemake.params.config, snakemake.params.library)
source |= model_attributes(snakemake.input.model)
stopwatch = Stopwatch()
records = dict(zip(cases, snakemake.output.records, strict=False))
series = dict(zip(cases, snakemake.output.series, strict=False))
writer = series_writer(config, model, series, source)
for case, record in simulate_cases(config, model, cases, writer, stopwatch):
    write_record_parts(record.assign_attrs(record.attrs | source), records[case], series.get(case))
print(stopwatch.line())
