"""Simulate all cases of one load and write their records and time series."""

import sys

from vibroimpact.cases import cases_of_load
from vibroimpact.provenance import origin
from vibroimpact.records import read_model, split_record, write_record
from vibroimpact.settings import Settings
from vibroimpact.simulate import simulate_cases

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config = Settings(snakemake.params.config)
cases = cases_of_load(config.grid, float(snakemake.wildcards.load))
records = simulate_cases(config, read_model(snakemake.input.model), cases)
for (case, record), *paths in zip(records, snakemake.output.records, snakemake.output.series, strict=True):
    record.attrs.update(origin(snakemake.params.config, snakemake.input.library))
    for part, path in zip(split_record(record), paths, strict=True):
        write_record(part, path)
    print(f"{case.id} written")
