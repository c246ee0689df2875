"""Draw the figures that compare the methods and check the simulations."""

from pathlib import Path

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.figures.drawing import save_plots
from vibroimpact.figures.study import checks, equivalent
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.case_files import read_case

redirect_output(snakemake.log[0])
config, model = StageSettings(snakemake.params.config), read_model(snakemake.input.model)
rows = read_table(snakemake.input.table)
records = checks.records_shown(snakemake.input.records, read_case)
plots = [
    *equivalent.figure_13_equivalent_support(config, model, rows),
    *equivalent.collapse(config, model, rows),
    *checks.energy_balance(config, records),
    *checks.contact_statistics(config, model, records),
]
save_plots(plots, Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
