"""The paper's claims, measured on the default study: table and figures."""

from pathlib import Path

from evidence.validation.claims.table import all_claims
from evidence.validation.figures.claims import claims_of_the_peak, claims_of_the_shape
from evidence.validation.study_curves import read_curves
from vibroimpact.config.reading import check_config
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table, write_table
from vibroimpact.reduction.model_file import read_model
from vibroimpact.reports.figures.drawing import save_plots

redirect_output(snakemake.log[0])
config = check_config(snakemake.params.config, "the study's configuration")
model = read_model(snakemake.input.model)
gaps = [
    read_curves(config, model, Path(snakemake.input.model).parent, gap)
    for gap in (max(config.grid.gap_m), min(config.grid.gap_m))
]
claims = all_claims(
    config,
    model,
    gaps,
    read_table(snakemake.input.steps),
    read_table(snakemake.input.modes),
    read_table(snakemake.input.quality),
)
write_table([claim.row() for claim in claims], snakemake.output.table)
plots = [claims_of_the_peak(model, gaps), claims_of_the_shape(model, gaps)]
save_plots(plots, Path(snakemake.output.figures[0]).parent)
print("\n".join(f"{claim.verdict}: {claim.claim}" for claim in claims))
