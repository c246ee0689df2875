"""Draw the figures of a diagnosis and write its report page."""

from pathlib import Path

from vibroimpact.config.schema import Config
from vibroimpact.diagnosis.identified.structure_file import model_from
from vibroimpact.figures.diagnosis.sheets import diagnosis_figures
from vibroimpact.figures.drawing import save_plots
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_record, write_text
from vibroimpact.reports.discrepancy_page import FREE_RUNS, NOISE, discrepancy_page
from vibroimpact.verdict.content import read_verdict

redirect_output(snakemake.log[0])
model = model_from(snakemake.params.model)
with_model = isinstance(model, Config)
files, folder = snakemake.input, Path(snakemake.output.page).parent
verdict = read_verdict(files.verdict)
plots = diagnosis_figures(
    read_record(files.evidence),
    read_record(files.spectra),
    verdict,
    model if with_model else None,
)
shown = save_plots(plots, folder / "figures")
write_text(
    discrepancy_page(
        snakemake.params.name,
        verdict,
        shown,
        FREE_RUNS if with_model else NOISE,
        str(folder / "model_updated.yaml"),
    ),
    snakemake.output.page,
)
print(f"{snakemake.output.page} written, {len(shown)} figures")
