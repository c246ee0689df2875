"""The figures and the report page of a user's completion."""

from pathlib import Path

from vibroimpact.completion.store import read_kept, read_values
from vibroimpact.completion.study import study_of
from vibroimpact.figures.discrepancy.completion import saved_sheets
from vibroimpact.job_log import redirect_output
from vibroimpact.records import read_table, write_text
from vibroimpact.reports.discrepancy_page import NOISE, discrepancy_page
from vibroimpact.verdict.file import read_verdict

redirect_output(snakemake.log[0])
files = snakemake.input
prepared, linear, completed = map(read_values, (files.study, files.linear, files.completed))
verdict = read_verdict(files.verdict)
tables = read_table(files.mounting), read_table(files.prediction)
shown = saved_sheets(
    snakemake.output.figures,
    read_kept(files.campaign),
    study_of(prepared),
    linear,
    completed,
    verdict,
    *tables,
)
model = str(Path(snakemake.output.page).with_name("model_updated.yaml"))
write_text(
    discrepancy_page(snakemake.params.name, verdict, shown, NOISE, model=model),
    snakemake.output.page,
)
