"""Draw the figures of the responses."""

from pathlib import Path

from vibroimpact.campaign.file import read_campaign
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.figures.study import overlay, psd_table, response
from vibroimpact.job_log import redirect_output
from vibroimpact.records import read_record
from vibroimpact.reduction.model_file import read_model
from vibroimpact.stopwatch import Stopwatch

redirect_output(snakemake.log[0])
config, model = StageSettings(snakemake.params.config), read_model(snakemake.input.model)
responses = psd_table.gather(
    config, model, psd_table.spectra_shown(config, snakemake.input.spectra, read_record)
)
sheets = overlay.figure_05_overlay(
    config, model, responses, read_campaign(snakemake.input.campaign)
) + response.in_plane_share(config, responses)
for draw in (
    response.figure_06_levels,
    response.figure_07_overlay_of_loads,
    response.figure_08_load_and_stiffness,
):
    sheets += draw(config, model, responses)
for sheet in sheets:
    sheet.save(Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
