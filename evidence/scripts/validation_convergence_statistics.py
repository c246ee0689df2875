"""Linear modes, energy balance and response statistics against step and modes: rows, checks,
figures.
"""

from pathlib import Path

from evidence.validation.convergence import (
    period as convergence_period,
)
from evidence.validation.convergence import (
    statistics as convergence_statistics,
)
from evidence.validation.figures import convergence_runs as figures
from vibroimpact.config.reading import check_config
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table, write_table
from vibroimpact.reports.figures.drawing import save_plots

redirect_output(snakemake.log[0])
periods = convergence_period.period_rows(
    check_config(snakemake.params.config, "the study's configuration")
)
table = convergence_statistics.statistics_rows(
    [row for path in snakemake.input.runs for row in read_table(path)]
)
checks = (
    convergence_period.period_checks(periods)
    + convergence_statistics.statistics_checks(table)
    + convergence_statistics.energy_checks(table)
)
for rows, path in zip(
    (periods, table, [check.row() for check in checks]), snakemake.output.tables, strict=True
):
    write_table(rows, path)
plots = figures.step(periods, table) + figures.both_axes(table)
save_plots(plots, Path(snakemake.output.figures[0]).parent)
