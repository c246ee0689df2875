"""Identify the equivalent supports of a measured tube: tables, figures and page."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from vibroimpact.config.reading import check_config
from vibroimpact.config.stage_keys import answer_digest
from vibroimpact.equivalent_support.measured.equivalent_of import equivalent_of
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_text
from vibroimpact.reports.captions import read_caption
from vibroimpact.reports.figures.drawing import save_plots
from vibroimpact.reports.figures.interactive.study_plots import measured_plots
from vibroimpact.reports.figures.study.measured import measured_figures, study_beside
from vibroimpact.reports.study_content import measured_content
from vibroimpact.reports.study_page import pictures, study_page
from vibroimpact.study.headline import flag_sentences


def make(given: Any, made: Any, params: Any) -> None:
    """given: campaign, captions. made: page; tables and figures lie in its folder. params: model
    in plain values, library, name of the campaign, study: folder of the study drawn behind the
    points, or None.
    """
    values, folder = params.model, Path(made.page).parent
    config = check_config(values, "the model")
    found = equivalent_of(str(given.campaign), config)
    found.write(folder, file_attributes(values, params.library), answer_digest(values))
    plots = measured_figures(found, study_beside(config, params.study))
    files = save_plots(plots, folder / "figures")
    content = measured_content(found, params.name, values, flag_sentences(found.equivalent))
    captions = {
        name: replace(read_caption(path), name=name)
        for path in given.captions
        for name in [Path(path).stem.removeprefix("measured_")]
    }
    page = study_page(content, measured_plots(content, found), pictures(files, captions))
    write_text(page, made.page)
    print(*content.found, sep="\n")
