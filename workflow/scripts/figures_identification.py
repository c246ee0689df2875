"""Draw the figures of the identifications, for the largest gap."""

from pathlib import Path

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.figures.drawing import save_plots
from vibroimpact.figures.study import broadband, poles, shapes, stabilisation
from vibroimpact.figures.study.cases_of_gap import cases_of_gap, shown_gap
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.case_files import read_case

redirect_output(snakemake.log[0])
config, model = StageSettings(snakemake.params.config), read_model(snakemake.input.model)
rows = [row for row in read_table(snakemake.input.table) if row["gap_m"] == shown_gap(config)]
curves = cases_of_gap(snakemake.input.curves, config, read_case)
spectra = cases_of_gap(snakemake.input.spectra, config, read_case)
plots = [
    *poles.figure_09_poles(config, model, curves, spectra, rows),
    *stabilisation.figure_09_stabilisation(config, curves, spectra, rows),
    *shapes.figure_10_shapes(config, model, curves, rows),
    *shapes.figure_11_singular_values(config, curves),
    *broadband.figure_12_broadband(config, model, curves, spectra, rows),
]
save_plots(plots, Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
