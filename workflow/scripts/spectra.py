"""Write the spectra of all cases of one load."""

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_record
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.study.case_files import read_case
from vibroimpact.study.case_spectra import case_spectra

redirect_output(snakemake.log[0])
config, stopwatch = StageSettings(snakemake.params.config), Stopwatch()
for series, path in zip(snakemake.input.series, snakemake.output.spectra, strict=True):
    record = read_case(series)
    spectra = stopwatch.time("spectra", case_spectra, config, record)
    write_record(
        spectra.assign_attrs(file_attributes(snakemake.params.config, snakemake.params.library)),
        path,
    )
    print(f"{path} written")
print(stopwatch.line())
