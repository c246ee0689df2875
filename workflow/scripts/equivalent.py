"""Identify the equivalent supports of a measured tube: tables, figures and page."""

from dataclasses import replace
from pathlib import Path

from vibroimpact.config.reading import check_config
from vibroimpact.config.stage_keys import answer_digest
from vibroimpact.figures.drawing import save_plots
from vibroimpact.figures.interactive.measured_plots import measured_plots
from vibroimpact.figures.interactive.pictures import pictures
from vibroimpact.figures.study.measured import measured_figures, study_beside
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_text
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.measured_support.equivalent_of import equivalent_of
from vibroimpact.measured_support.files import write_measured
from vibroimpact.reports.captions import read_caption
from vibroimpact.reports.measured_content import measured_content
from vibroimpact.reports.study_page import study_page
from vibroimpact.study.run_report import flag_sentences

redirect_output(snakemake.log[0])
values, folder = snakemake.params.model, Path(snakemake.output.page).parent
config = check_config(values, "the model")
found = equivalent_of(str(snakemake.input.campaign), config)
attributes = file_attributes(values, snakemake.params.library)
write_measured(found, folder, attributes, answer_digest(values))
plots = measured_figures(found, study_beside(config, snakemake.params.study))
files = save_plots(plots, folder / "figures")
content = measured_content(found, snakemake.params.name, values, flag_sentences(found.equivalent))
captions = {
    name: replace(read_caption(path), name=name)
    for path in snakemake.input.captions
    for name in [Path(path).stem.removeprefix("measured_")]
}
drawn = pictures(files, captions)
write_text(study_page(content, measured_plots(content, found), drawn), snakemake.output.page)
print(*content.headline(), sep="\n")
print(Stopwatch().line())
