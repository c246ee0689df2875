"""Draw the figures of the model."""

import sys
from pathlib import Path

from vibroimpact.figures import basis, contact, tube
from vibroimpact.records import read_table
from vibroimpact.settings import Settings
from vibroimpact.stopwatch import Stopwatch
from vibroimpact.structure import build_structure

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config = Settings(snakemake.params.config)
structure = build_structure(config)
sheets = [*tube.figure_01_layout(config, structure), *tube.figure_02_free_modes(config, structure)]
sheets += [*contact.figure_03_contact_law(config, structure), *contact.figure_04_first_frequency(config)]
for sheet in [*sheets, *basis.basis_quality(config, read_table(snakemake.input.quality))]:
    sheet.save(Path(snakemake.output.figures[0]).parent)
print(Stopwatch().line())
