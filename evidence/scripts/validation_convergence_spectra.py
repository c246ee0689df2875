"""What length, buffer, overlap and window of a record are worth: rows, checks, figure."""

from pathlib import Path

from evidence.validation.convergence import (
    impacts as convergence_impacts,
)
from evidence.validation.convergence import (
    spectra as convergence_spectra,
)
from evidence.validation.figures.convergence_spectra import spectra
from vibroimpact.config.reading import check_config
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reports.figures.drawing import save_plots

redirect_output(snakemake.log[0])
config = check_config(snakemake.params.config, "the study's configuration")
averages = convergence_spectra.averages_rows(build_model(config), config.seed)
leakage = convergence_spectra.leakage_rows(build_model(config))
impacts = convergence_impacts.impact_rows(config, *convergence_impacts.impact_spectra(config))
checks = convergence_spectra.checks(averages) + convergence_impacts.impact_checks(impacts)
for rows, path in zip(
    (averages, leakage, impacts, [check.row() for check in checks]),
    snakemake.output.tables,
    strict=True,
):
    write_table(rows, path)
save_plots(spectra(averages, leakage, impacts), Path(snakemake.output.figures[0]).parent)
