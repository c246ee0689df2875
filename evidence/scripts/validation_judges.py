"""What third-party codes say of the tube, its impacts, poles and spectra: Checks of those
installed, and which were absent.
"""

from pathlib import Path

from evidence.validation.figures.judges import judged_impacts
from evidence.validation.judges.modes import oval_bend_rows
from evidence.validation.judges.table import all_verdicts
from vibroimpact.config.reading import check_config
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table, write_text

redirect_output(snakemake.log[0])
config = check_config(snakemake.params.config, "the study's configuration")
verdicts = all_verdicts(config)
write_table([check.row() for check in verdicts.checks], snakemake.output.checks)
write_table(oval_bend_rows(config), snakemake.output.oval_bend)
write_text(verdicts.presence(), snakemake.output.presence)
judged_impacts(verdicts, min(config.grid.gap_m)).save(Path(snakemake.output.figures[0]).parent)
print(verdicts.presence())
