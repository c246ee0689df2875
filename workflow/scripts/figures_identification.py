"""Draw the figures of the identifications, for the largest gap."""

import sys
from pathlib import Path

from vibroimpact.figures import broadband, poles, shapes
from vibroimpact.figures.cases_of_gap import cases_of_gap, shown_gap
from vibroimpact.records import read_model, read_record, read_table
from vibroimpact.settings import Settings
from vibroimpact.stopwatch import Stopwatch

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, model = Settings(snakemake.params.config), read_model(snakemake.input.model)
rows = [row for row in read_table(snakemake.input.table) if row["gap_m"] == shown_gap(config)]
curves, spectra = (cases_of_gap(paths, config, read_record) for paths in (snakemake.input.curves, snakemake.input.spectra))
sheets = poles.figure_09_poles(config, model, curves, spectra, rows) + poles.figure_09_stabilisation(config, curves, spectra, rows)
sheets += shapes.figure_10_shapes(config, model, curves, rows) + shapes.figure_11_singular_values(config, curves)
for sheet in sheets + broadband.figure_12_broadband(config, model, curves, spectra, rows):
    sheet.save(Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
