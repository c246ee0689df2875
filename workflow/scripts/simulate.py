"""Simulate all cases of one load and write their records, and their time series where they are
kept.
"""

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.job_log import redirect_output
from vibroimpact.provenance import origin
from vibroimpact.reduction.model_file import read_model
from vibroimpact.stopwatch import Stopwatch
from vibroimpact.study.cases import cases_of_load
from vibroimpact.study.series_files import series_files, write_parts
from vibroimpact.study.simulation import simulate_cases

redirect_output(snakemake.log[0])
config, model = StageSettings(snakemake.params.config), read_model(snakemake.input.model)
cases = cases_of_load(config.grid, float(snakemake.wildcards.load))
source = origin(snakemake.params.config, snakemake.input.library)
stopwatch = Stopwatch()
records = dict(zip(cases, snakemake.output.records, strict=False))
series = dict(zip(cases, snakemake.output.series, strict=False))
for case, record in simulate_cases(
    config, model, cases, series_files(config, model, series, source), stopwatch
):
    write_parts(record.assign_attrs(record.attrs | source), records[case], series.get(case))
print(stopwatch.line())
