"""Draw the figures that compare the methods and check the simulations."""

from pathlib import Path
from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.records import read_table
from vibroimpact.reduction.model_file import read_model
from vibroimpact.reports.figures.drawing import save_plots
from vibroimpact.reports.figures.study import checks, equivalent
from vibroimpact.reports.study_statistics import study_statistics
from vibroimpact.study.case_files import read_case


def make(given: Any, made: Any, params: Any) -> None:
    """given: model, records, table. made: figures. params: config."""
    config, model = StageSettings(params.config), read_model(given.model)
    rows = read_table(given.table)
    statistics = study_statistics(given.records, read_case)
    energies = read_case(checks.file_of_energies(given.records), ("energy",))
    plots = [
        equivalent.figure_13_equivalent_support(config, model, rows),
        equivalent.collapse(config, model, rows),
        checks.energy_balance(config, statistics, energies),
        checks.contact_statistics(config, model, statistics),
    ]
    save_plots(plots, Path(made.figures[0]).parent)
