"""Build and write the reduced model and its quality report."""

import sys

from vibroimpact.provenance import origin
from vibroimpact.records import write_model, write_table
from vibroimpact.reduction import build_model, quality_report
from vibroimpact.settings import Settings
from vibroimpact.stopwatch import Stopwatch

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config = Settings(snakemake.params.config)
model = build_model(config)
print(f"{model.modes} modes")
write_model(model, snakemake.output.model, origin(snakemake.params.config, snakemake.input.library))
write_table(quality_report(config), snakemake.output.quality)
print(Stopwatch().line())
