"""A group of reference cases through the public interface: frequencies, impacts, tubes, or random
motion between stops.
"""

from pathlib import Path

from evidence.validation.check import COLUMNS
from evidence.validation.reference.runs import ORDER_COLUMNS, reference_group
from vibroimpact.config.reading import check_config
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table

redirect_output(snakemake.log[0])
study = check_config(snakemake.params.config, "the study's configuration")
checks, rows = reference_group(
    snakemake.wildcards.group, study, Path(snakemake.input.configs[0]).parent
)
write_table([check.row() for check in checks], snakemake.output.checks, COLUMNS)
write_table(rows, snakemake.output.rows, ORDER_COLUMNS)
print(f"{sum(check.passed for check in checks)} of {len(checks)} within tolerance")
