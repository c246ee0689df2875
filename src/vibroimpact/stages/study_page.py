"""Write the page of a study, and its wear life if it has one."""

from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.records import read_attributes, read_table, write_table, write_text
from vibroimpact.reduction.model_accuracy import mesh_warnings
from vibroimpact.reduction.model_file import read_model
from vibroimpact.reports.captions import read_caption
from vibroimpact.reports.equivalent_answer import answers, unmoved
from vibroimpact.reports.figures.interactive.study_plots import StudyFiles, study_plots
from vibroimpact.reports.figures.study.checks import limits
from vibroimpact.reports.study_content import provenance, study_content
from vibroimpact.reports.study_page import pictures, study_page
from vibroimpact.reports.study_statistics import study_statistics
from vibroimpact.study.case_files import read_case
from vibroimpact.study.headline import flag_sentences
from vibroimpact.study.timing import timing_so_far
from vibroimpact.study.wear.life import WearRow, wear_rows

NAMES = ("group", "direction")  # columns of tables: a name may read as a number


def make(given: Any, made: Any, params: Any) -> None:
    """given: model, accuracy, records, series, spectra, curves, tables, figures, captions. made:
    page, wear. params: config, jobs: benchmark files and logs of the study.
    """
    config = StageSettings(params.config)
    tables = {Path(path).stem: read_table(path, NAMES) for path in given.tables}
    summary, equivalent = (tables.get(name, []) for name in ("consistency_summary", "equivalent"))
    stages = {
        stage: read_attributes(paths[0])
        for stage, paths in (
            ("reduced model", [given.model]),
            ("simulation", given.records),
            ("spectra", given.spectra),
            ("identification", given.curves),
        )
        if paths
    }
    worn = wear_rows(config, given.records, config.wear) if config.wear is not None else []
    content = study_content(
        config,
        answers(summary, equivalent),
        study_statistics(given.records, read_case),
        provenance(params.config, stages, timing_so_far(*params.jobs)),
        unmoved(equivalent),
        worn,
        limits=limits(config.integration),
        warnings=[*mesh_warnings(read_table(given.accuracy)), *flag_sentences(equivalent)],
    )
    model = read_model(given.model)
    files = StudyFiles(model, given.series, given.spectra, given.curves, summary, read_case)
    captions = {caption.name: caption for caption in map(read_caption, given.captions)}
    page = study_page(content, study_plots(content, files), pictures(given.figures, captions))
    write_text(page, made.page)
    if config.wear is not None:
        columns = tuple(field.name for field in fields(WearRow))
        write_table([asdict(row) for row in worn], made.wear[0], columns)
    print(f"{len(page.encode()) / 1e6:.1f} MB")
