"""Draw the figures of the model."""

from pathlib import Path

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.figures.drawing import save_plots
from vibroimpact.figures.study import basis, contact, tube
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.structure.tube import build_structure

redirect_output(snakemake.log[0])
config = StageSettings(snakemake.params.config)
structure = build_structure(config)
plots = [
    *tube.figure_01_layout(config, structure),
    *tube.figure_02_free_modes(config, structure),
    *contact.figure_03_contact_law(config, structure),
    *contact.figure_04_first_frequency(config),
    *basis.basis_quality(config, read_table(snakemake.input.quality)),
]
save_plots(plots, Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
