"""Draw the figures of a discrepancy run and write its report page."""

import sys
from pathlib import Path

from vibroimpact.discrepancy.dag import QUICK_S
from vibroimpact.discrepancy_page import discrepancy_page
from vibroimpact.discrepancy_results import read_results
from vibroimpact.figures.discrepancy import discrepancy_figures
from vibroimpact.records import write_text

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
folder = Path(snakemake.output.page).parent
results = read_results(folder)
sheets = discrepancy_figures(results)
for sheet in sheets:
    sheet.save(folder / "figures")
shown = [folder / "figures" / f"{sheet.name}.png" for sheet in sheets if sheet.tables]
write_text(discrepancy_page(snakemake.params.name, results.verdict, shown, quick_s=QUICK_S if snakemake.params.quick else None), snakemake.output.page)
print(f"{snakemake.output.page} written, {len(shown)} figures")
