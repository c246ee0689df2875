"""Write down whether a discrepancy run is a quick or a full one."""

from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_text

redirect_output(snakemake.log[0])
write_text(f"{snakemake.params.mode}\n", snakemake.output.mode)
