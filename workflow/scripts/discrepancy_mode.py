"""Write down by which search, and with what effort, a discrepancy run was made."""

from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_text

redirect_output(snakemake.log[0])
write_text(f"{snakemake.params.mode}\n", snakemake.output.mode)
