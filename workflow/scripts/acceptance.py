"""Compare the verdicts of a draw with their truths: tables, figures and the page."""

from pathlib import Path

from vibroimpact.acceptance.calibration import reliability
from vibroimpact.acceptance.campaign_rows import read_shards, stated_in
from vibroimpact.acceptance.detection_limit import detection
from vibroimpact.acceptance.table import acceptance_table, confusion
from vibroimpact.figures.acceptance.sheets import acceptance_figures
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table, write_text
from vibroimpact.reports.acceptance_page import acceptance_page

redirect_output(snakemake.log[0])
folder = Path(snakemake.output.page).parent
rows = read_shards(folder, snakemake.input.added)
stated = stated_in(rows)
curve = reliability(stated)
tables = {
    "campaigns": rows,
    "table": acceptance_table(rows, stated),
    "reliability": curve,
    "confusion": confusion(rows),
    "detection": detection(rows),
}
for name, table in tables.items():
    write_table(table, snakemake.output[name])
for sheet in acceptance_figures(rows, tables):
    sheet.save(folder / "figures")
write_text(
    acceptance_page(
        folder.name,
        rows,
        tables,
        [file for file in snakemake.output.figures if file.endswith(".png")],
    ),
    snakemake.output.page,
)
print(f"{len(rows)} campaigns judged: {snakemake.output.page}")
