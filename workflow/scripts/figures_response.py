"""Draw the figures of the responses."""

from pathlib import Path

from vibroimpact.campaign.file import read_campaign
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.figures.drawing import save_plots
from vibroimpact.figures.study import overlay, psd_table, response
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.case_files import read_case

redirect_output(snakemake.log[0])
config, model = StageSettings(snakemake.params.config), read_model(snakemake.input.model)
campaign = read_campaign(snakemake.input.campaign, force_needed=False)
spectra = psd_table.spectra_shown(config, snakemake.input.spectra, read_case)
responses = psd_table.gather(config, model, spectra)
plots = [
    *overlay.figure_05_overlay(config, model, responses, campaign),
    *response.figure_06_levels(config, model, responses),
    *response.figure_07_overlay_of_loads(config, model, responses),
    *response.figure_08_load_and_stiffness(config, model, responses),
    *response.in_plane_share(config, responses),
]
save_plots(plots, Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
