"""Draw the figures of the model."""

from pathlib import Path
from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.records import read_table
from vibroimpact.reports.figures.drawing import save_plots
from vibroimpact.reports.figures.study import basis, contact, tube
from vibroimpact.structure.tube import build_structure


def make(given: Any, made: Any, params: Any) -> None:
    """given: quality. made: figures. params: config."""
    config = StageSettings(params.config)
    structure = build_structure(config)
    plots = [
        tube.figure_01_layout(config, structure),
        tube.figure_02_free_modes(config, structure),
        contact.figure_03_contact_law(config, structure),
        contact.figure_04_first_frequency(config),
        basis.basis_quality(config, read_table(given.quality)),
    ]
    save_plots(plots, Path(made.figures[0]).parent)
