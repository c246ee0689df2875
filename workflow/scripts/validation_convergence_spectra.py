"""What length, buffer, overlap and window of a record are worth: rows, checks, figure."""

import sys
from pathlib import Path

from vibroimpact.config import check_config
from vibroimpact.figures.validation_convergence_spectra import spectra
from vibroimpact.records import write_table
from vibroimpact.reduction import build_model
from vibroimpact.validation import convergence_impacts, convergence_spectra

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config = check_config(snakemake.params.config, "the study's configuration")
averages, leakage = convergence_spectra.averages_rows(build_model(config), config.seed), convergence_spectra.leakage_rows(build_model(config))
impacts = convergence_impacts.impact_rows(config, *convergence_impacts.impact_spectra(config))
checks = convergence_spectra.checks(averages) + convergence_impacts.impact_checks(impacts)
for rows, path in zip((averages, leakage, impacts, [check.row() for check in checks]), snakemake.output.tables, strict=True):
    write_table(rows, path)
spectra(averages, leakage, impacts)[0].save(Path(snakemake.output.figures[0]).parent)
