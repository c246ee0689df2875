"""Draw the figures of the identifications, for the largest gap."""

from pathlib import Path
from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.records import read_table
from vibroimpact.reduction.model_file import read_model
from vibroimpact.reports.figures.drawing import save_plots
from vibroimpact.reports.figures.study import broadband, poles, shapes
from vibroimpact.reports.figures.study.cases_of_gap import ReadOnDemand, cases_of_gap, shown_gap
from vibroimpact.study.case_files import read_case


def make(given: Any, made: Any, params: Any) -> None:
    """given: model, spectra, curves, table. made: figures. params: config."""
    config, model = StageSettings(params.config), read_model(given.model)
    rows = [row for row in read_table(given.table) if row["gap_m"] == shown_gap(config)]
    curves = {case: read_case(path) for case, path in cases_of_gap(given.curves, config).items()}
    spectra = ReadOnDemand(cases_of_gap(given.spectra, config), read_case)
    plots = [
        poles.figure_09_poles(config, model, curves, spectra, rows),
        poles.figure_09_stabilisation(config, curves, spectra, rows),
        shapes.figure_10_shapes(config, model, curves, rows),
        shapes.figure_11_singular_values(config, curves),
        broadband.figure_12_broadband(config, model, curves, spectra, rows),
    ]
    save_plots(plots, Path(made.figures[0]).parent)
