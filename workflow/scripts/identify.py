"""Write the estimates of all cases of some loads, and the curves behind them."""

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.identify.estimate import table_rows
from vibroimpact.identify.identify_case import RECORD_READ, SPECTRA_READ, identify_case
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.records import write_record, write_table
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.case_files import read_case

redirect_output(snakemake.log[0])
config = StageSettings(snakemake.params.config)
model = read_model(snakemake.input.model)
stopwatch = Stopwatch()
source = file_attributes(snakemake.params.config, snakemake.params.library)
for record_path, spectra_path, table_path, curves_path in zip(
    snakemake.input.records,
    snakemake.input.spectra,
    snakemake.output.tables,
    snakemake.output.curves,
    strict=True,
):
    record = read_case(record_path, RECORD_READ)
    spectra = read_case(spectra_path, SPECTRA_READ)
    estimates, curves = stopwatch.time(
        "identification", identify_case, config, model, record, spectra
    )
    write_table(table_rows(estimates, record.attrs), table_path)
    write_record(curves.assign_attrs(record.attrs | source), curves_path)
    print(
        record.attrs["case"],
        *(f"{item.method}: {item.k:.3g} N/m {item.quality} {item.note}" for item in estimates),
        sep="\n  ",
    )
print(stopwatch.line())
