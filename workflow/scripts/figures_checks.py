"""Draw the figures that compare the methods and check the simulations."""

import sys
from functools import partial
from pathlib import Path

from vibroimpact.figures import checks, equivalent
from vibroimpact.figures.cases_of_gap import CasesOnDemand
from vibroimpact.records import read_model, read_record, read_table
from vibroimpact.settings import Settings

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, model = Settings(snakemake.params.config), read_model(snakemake.input.model)
rows, records = read_table(snakemake.input.table), CasesOnDemand(snakemake.input.records, partial(read_record, names=checks.VARIABLES))
sheets = equivalent.figure_13_equivalent_support(config, model, rows) + equivalent.collapse(config, model, rows)
for sheet in sheets + checks.energy_balance(config, records) + checks.contact_statistics(config, records):
    sheet.save(Path(snakemake.output.figures[0]).parent)
