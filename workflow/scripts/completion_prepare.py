"""The first step of a user's completion: usable records, study, linear models, places."""

from vibroimpact.completion.mounting import COLUMNS
from vibroimpact.completion.prepare import prepared
from vibroimpact.completion.store import write_kept, write_values
from vibroimpact.completion.structure_file import StructureFile
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table
from vibroimpact.run_cost import job_cost

redirect_output(snakemake.log[0])
with job_cost(snakemake.output.study, "prepare", begun=0.0):
    name = snakemake.output.campaign.split("/")[-2]
    values, campaign, linear, mounting = prepared(
        name, snakemake.input.campaign, StructureFile(**snakemake.params.structure)
    )
    write_kept(campaign, snakemake.output.campaign)
    write_values(linear, snakemake.output.linear)
    write_table(mounting, snakemake.output.mounting, COLUMNS)
    write_values(values, snakemake.output.study)
