"""Draw the figures of the responses."""

import sys
from pathlib import Path

from vibroimpact.campaign import read_campaign
from vibroimpact.figures import overlay, psd_table, response
from vibroimpact.records import read_model, read_record
from vibroimpact.settings import Settings
from vibroimpact.stopwatch import Stopwatch

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, model = Settings(snakemake.params.config), read_model(snakemake.input.model)
responses = psd_table.gather(config, model, psd_table.spectra_shown(config, snakemake.input.spectra, read_record))
sheets = overlay.figure_05_overlay(config, model, responses, read_campaign(snakemake.input.campaign)) + response.in_plane_share(config, responses)
for draw in (response.figure_06_levels, response.figure_07_overlay_of_loads, response.figure_08_load_and_stiffness):
    sheets += draw(config, model, responses)
for sheet in sheets:
    sheet.save(Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
