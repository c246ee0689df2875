"""Draw the figures that compare the methods and check the simulations."""

import sys
from pathlib import Path

from vibroimpact.figures import checks, equivalent
from vibroimpact.records import read_model, read_record, read_table
from vibroimpact.settings import Settings
from vibroimpact.stopwatch import Stopwatch

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, model = Settings(snakemake.params.config), read_model(snakemake.input.model)
rows, records = read_table(snakemake.input.table), checks.records_shown(snakemake.input.records, read_record)
sheets = equivalent.figure_13_equivalent_support(config, model, rows) + equivalent.collapse(config, model, rows)
for sheet in sheets + checks.energy_balance(config, records) + checks.contact_statistics(config, records):
    sheet.save(Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
