"""Draw the figures of the responses."""

from pathlib import Path
from typing import Any

from vibroimpact.campaign.file import read_campaign
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.reduction.model_file import read_model
from vibroimpact.reports.figures.drawing import save_plots
from vibroimpact.reports.figures.study import overlay, psd_table, response
from vibroimpact.study.case_files import read_case


def make(given: Any, made: Any, params: Any) -> None:
    """given: model, campaign, spectra. made: figures. params: config."""
    config, model = StageSettings(params.config), read_model(given.model)
    campaign = read_campaign(given.campaign, force_needed=False)
    spectra = psd_table.spectra_shown(config, given.spectra, read_case)
    responses = psd_table.gather(config, model, spectra)
    plots = [
        overlay.figure_05_overlay(config, model, responses, campaign),
        response.figure_06_levels(config, model, responses),
        response.figure_07_overlay_of_loads(config, model, responses),
        response.figure_08_load_and_stiffness(config, model, responses),
        response.in_plane_share(config, responses),
    ]
    save_plots(plots, Path(made.figures[0]).parent)
