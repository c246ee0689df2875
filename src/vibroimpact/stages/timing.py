"""Sum the benchmark files and logs of a study into a table and a figure."""

from pathlib import Path
from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.records import write_table
from vibroimpact.reports.figures.drawing import save_plots
from vibroimpact.reports.figures.study.timing import timing
from vibroimpact.study.timing import study_timing


def make(given: Any, made: Any, params: Any) -> None:
    """given: benchmarks. made: table, figures. params: config, logs."""
    rows = study_timing(given.benchmarks, params.logs)
    write_table(rows, made.table)
    plot = timing(StageSettings(params.config), rows)
    save_plots([plot], Path(made.figures[0]).parent)
