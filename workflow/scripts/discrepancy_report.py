"""Draw the figures of a discrepancy run and write its report page."""

from pathlib import Path

from vibroimpact.config.reading import check_config
from vibroimpact.discrepancy.results_folder import read_results
from vibroimpact.figures.discrepancy.sheets import discrepancy_figures
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_text
from vibroimpact.reports.discrepancy_page import discrepancy_page

redirect_output(snakemake.log[0])
folder = Path(snakemake.output.page).parent
results = read_results(folder)
sheets = discrepancy_figures(results, check_config(snakemake.params.config, "model"))
for sheet in sheets:
    sheet.save(folder / "figures")
shown = [folder / "figures" / f"{sheet.name}.png" for sheet in sheets if sheet.tables]
write_text(
    discrepancy_page(
        snakemake.params.name,
        results.verdict,
        shown,
        model=str(folder / "model_updated.yaml"),
    ),
    snakemake.output.page,
)
print(f"{snakemake.output.page} written, {len(shown)} figures")
