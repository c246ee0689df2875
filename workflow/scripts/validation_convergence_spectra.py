"""What length, buffer, overlap and window of a record are worth: rows, checks, figure."""

from pathlib import Path

from vibroimpact.config.reading import check_config
from vibroimpact.figures.validation.convergence_spectra import spectra
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.validation.convergence import (
    impacts as convergence_impacts,
)
from vibroimpact.validation.convergence import (
    spectra as convergence_spectra,
)

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
spectra(averages, leakage, impacts)[0].save(Path(snakemake.output.figures[0]).parent)
