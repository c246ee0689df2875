"""Compare the verdicts of a draw with their truths: tables, figures and the page."""

from pathlib import Path

from evidence.acceptance.calibration import reliability
from evidence.acceptance.campaign_rows import read_shards, stated_in
from evidence.acceptance.detection_limit import detection
from evidence.acceptance.figures.sheets import acceptance_figures
from evidence.acceptance.page import acceptance_page
from evidence.acceptance.table import acceptance_table, confusion
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table, write_text

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
