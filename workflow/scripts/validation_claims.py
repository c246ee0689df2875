"""The paper's claims, measured on the default study: table and figures."""

import sys
from pathlib import Path

from vibroimpact.config import check_config
from vibroimpact.figures.validation_claims import claims_of_the_peak, claims_of_the_shape
from vibroimpact.records import read_model, read_table, write_table
from vibroimpact.validation.claims import all_claims
from vibroimpact.validation.study_curves import read_curves

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, model = check_config(snakemake.params.config, "the study's configuration"), read_model(snakemake.input.model)
gaps = [read_curves(config, model, Path(snakemake.input.model).parent, gap) for gap in (max(config.grid.gap_m), min(config.grid.gap_m))]
claims = all_claims(config, model, gaps, read_table(snakemake.input.steps), read_table(snakemake.input.modes), read_table(snakemake.input.quality))
write_table([claim.row() for claim in claims], snakemake.output.table)
for draw in (claims_of_the_peak, claims_of_the_shape):
    draw(model, gaps).save(Path(snakemake.output.figures[0]).parent)
print("\n".join(f"{claim.verdict}: {claim.claim}" for claim in claims))
