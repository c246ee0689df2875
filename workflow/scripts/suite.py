"""Compare the suite's verdicts with their truths: tables, figures and the page."""

from pathlib import Path

from vibroimpact.acceptance.detection_limit import detection
from vibroimpact.acceptance.rates import confusion, rates, read_shards
from vibroimpact.figures.suite.sheets import suite_figures
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table, write_text
from vibroimpact.reports.suite_page import suite_page

redirect_output(snakemake.log[0])
rows = read_shards(Path(snakemake.output.page).parent, snakemake.input.added)
tables = {
    "campaigns": rows,
    "rates": rates(rows),
    "confusion": confusion(rows),
    "detection": detection(rows),
}
for name, table in tables.items():
    write_table(table, snakemake.output[name])
for sheet in suite_figures(rows, tables["rates"], tables["confusion"]):
    sheet.save(Path(snakemake.output.page).parent / "figures")
write_text(
    suite_page(
        snakemake.params.seed,
        rows,
        tables["rates"],
        tables["detection"],
        [file for file in snakemake.output.figures if file.endswith(".png")],
    ),
    snakemake.output.page,
)
print(f"{len(rows)} campaigns judged: {snakemake.output.page}")
