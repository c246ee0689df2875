"""Write what linear supports predict of the study: one k and c for all, and each its own."""

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.equivalent_support import supports_prediction as supports
from vibroimpact.identify.identify_case import RECORD_READ, SPECTRA_READ
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import read_table, write_table
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.linear.support_groups import ALL
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.case_files import read_case
from vibroimpact.study.equivalent_table import EQUIVALENT_COLUMNS

redirect_output(snakemake.log[0])
settings, model = snakemake.params.config, read_model(snakemake.input.model)
of_all = {**settings, "identification": {**settings["identification"], "groups": ALL}}
records = [
    read_case(path, (*RECORD_READ, *supports.RECORD_READ)) for path in snakemake.input.records
]
spectra = [
    read_case(path, (*SPECTRA_READ, *supports.SPECTRA_READ)) for path in snakemake.input.spectra
]
one = supports.one_for_all(StageSettings(of_all), model, records, spectra)
equivalent = {supports.ONE: one, supports.EACH: read_table(snakemake.input.equivalent)}
rows = supports.supports_prediction_rows(
    StageSettings(settings), model, equivalent, records, spectra
)
write_table(one, snakemake.output.one, EQUIVALENT_COLUMNS)
write_table(rows, snakemake.output.table, supports.COLUMNS)
print(f"{len(rows)} comparisons")
print(Stopwatch().line())
