"""All comparisons in one table, the reference figures, and the page."""

from pathlib import Path

from evidence.validation.figures.reference import reference
from evidence.validation.page import page_tables, validation_page
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table, write_table, write_text

redirect_output(snakemake.log[0])
checks = [row for path in snakemake.input.checks for row in read_table(path)]
write_table(checks, snakemake.output.table)
folder = Path(snakemake.output.page).parent
reference(checks, read_table(snakemake.input.order)).save(folder / "figures")
figures = [
    *sorted(Path(path) for path in snakemake.input.figures if path.endswith(".png")),
    *map(Path, snakemake.output.figures[:1]),
]
tables = page_tables(read_table(snakemake.input.claims), read_table(snakemake.input.prediction))
write_text(validation_page(checks, tables, figures, folder), snakemake.output.page)
print(f"{len(checks)} comparisons")
