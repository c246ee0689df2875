"""Draw the figures of a diagnosis and write its page."""

from pathlib import Path
from typing import Any

from vibroimpact.config.schema import Config
from vibroimpact.diagnosis.identified.structure_file import model_from
from vibroimpact.diagnosis.verdict.content import read_verdict
from vibroimpact.io.records import read_record, write_text
from vibroimpact.reports.discrepancy_page import FREE_RUNS, NOISE, discrepancy_page
from vibroimpact.reports.figures.diagnosis.sheets import diagnosis_figures
from vibroimpact.reports.figures.drawing import save_plots


def make(given: Any, made: Any, params: Any) -> None:
    """given: verdict, evidence, spectra. made: page; the figures lie in figures/ of its folder.
    params: model in plain values, name of the campaign.
    """
    model = model_from(params.model)
    config = model if isinstance(model, Config) else None
    folder = Path(made.page).parent
    verdict = read_verdict(given.verdict)
    plots = diagnosis_figures(
        read_record(given.evidence), read_record(given.spectra), verdict, config
    )
    shown = save_plots(plots, folder / "figures")
    write_text(
        discrepancy_page(
            params.name,
            verdict,
            shown,
            NOISE if config is None else FREE_RUNS,
            str(folder / "model_updated.yaml"),
        ),
        made.page,
    )
    print(f"{made.page} written, {len(shown)} figures")
