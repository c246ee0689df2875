"""Check a campaign and draw it."""

import sys
from pathlib import Path

from vibroimpact.campaign.checks.file_checks import COLUMNS, check_file
from vibroimpact.campaign.importing.report import checks_text
from vibroimpact.figures.discrepancy.quicklook import quicklook
from vibroimpact.figures.drawing import save_plots
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.records import write_table, write_text

redirect_output(snakemake.log[0])
campaign, checks = check_file(snakemake.input.campaign, unmade=True)
print(checks_text(checks)) if campaign is not None else sys.exit(checks_text(checks))
write_table(checks, snakemake.output.checks, COLUMNS)
write_text(checks_text(checks), snakemake.output.text)
save_plots(quicklook(campaign), Path(snakemake.output.figure[0]).parent)
