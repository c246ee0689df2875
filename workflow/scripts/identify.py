"""Write the estimates of all cases of one load, and the curves behind them."""

import sys

from vibroimpact.identify.case import identify_case
from vibroimpact.identify.estimate import table_rows
from vibroimpact.provenance import origin
from vibroimpact.records import read_model, read_record, write_record, write_table
from vibroimpact.settings import Settings

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, model = Settings(snakemake.params.config), read_model(snakemake.input.model)
source = origin(snakemake.params.config, snakemake.input.library)
paths = zip(snakemake.input.records, snakemake.input.spectra, snakemake.output.tables, snakemake.output.curves, strict=True)
for record, spectra, table, curves in paths:
    record = read_record(record)
    estimates, shown = identify_case(config, model, record, read_record(spectra))
    write_table(table_rows(estimates, record.attrs), table)
    write_record(shown.assign_attrs(record.attrs | source), curves)
    print(record.attrs["case"], *(f"{item.method}: {item.k:.3g} N/m {item.quality} {item.note}" for item in estimates), sep="\n  ")
