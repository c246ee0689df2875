"""Verdict, prediction and completed model of a user's campaign."""

from vibroimpact.completion.outcome import outcome, write_outcome
from vibroimpact.completion.store import read_kept, read_values
from vibroimpact.completion.study import study_of
from vibroimpact.job_log import redirect_output
from vibroimpact.provenance import verdict_origin
from vibroimpact.run_cost import Meter, total_cost

redirect_output(snakemake.log[0])
meter = Meter("verdict", begun=0.0)
campaign, prepared = read_kept(snakemake.input.campaign), read_values(snakemake.input.study)
study, structure = study_of(prepared), snakemake.params.structure
source = verdict_origin(structure, snakemake.input.campaign, None)
singles, additions = (
    [read_values(path) for path in paths]
    for paths in (snakemake.input.singles, snakemake.input.additions)
)
told = outcome(
    campaign, study, prepared, read_values(snakemake.input.linear), singles, additions, source
)
files = snakemake.input
made = [files.study, *files.singles, *files.additions]
cost = total_cost(made, meter.read())
write_outcome(told, campaign, study, snakemake.output, cost)
