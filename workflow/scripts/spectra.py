"""Write the spectra of all cases of one load."""

import sys

from vibroimpact.provenance import origin
from vibroimpact.records import read_record, write_record
from vibroimpact.settings import Settings
from vibroimpact.spectra_of_case import case_spectra
from vibroimpact.stopwatch import Stopwatch

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
config, stopwatch = Settings(snakemake.params.config), Stopwatch()
for series, path in zip(snakemake.input.series, snakemake.output.spectra, strict=True):
    record = read_record(series)
    spectra = stopwatch.time("spectra", case_spectra, config, record)
    write_record(spectra.assign_attrs(origin(snakemake.params.config, snakemake.input.library)), path)
    print(f"{path} written")
print(stopwatch.line())
