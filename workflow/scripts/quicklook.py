"""Check a campaign and draw it."""

import sys
from pathlib import Path

from vibroimpact.campaign_checks import COLUMNS, check_file
from vibroimpact.figures.quicklook import quicklook
from vibroimpact.importing.report import checks_text
from vibroimpact.records import write_table, write_text

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
campaign, checks = check_file(snakemake.input.campaign)
print(checks_text(checks)) if campaign is not None else sys.exit(checks_text(checks))
write_table(checks, snakemake.output.checks, COLUMNS)
write_text(checks_text(checks), snakemake.output.text)
for sheet in quicklook(campaign):
    sheet.save(Path(snakemake.output.figure[0]).parent)
