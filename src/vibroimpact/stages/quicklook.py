"""Check a campaign and draw it."""

import sys
from pathlib import Path
from typing import Any

from vibroimpact.campaign.checks.file_checks import check_file
from vibroimpact.campaign.checks.stated import COLUMNS
from vibroimpact.campaign.importing.report import checks_text
from vibroimpact.io.records import write_table, write_text
from vibroimpact.reports.figures.drawing import save_plots
from vibroimpact.reports.figures.quicklook import quicklook


def make(given: Any, made: Any, params: Any) -> None:
    """given: campaign. made: checks, text, figure. Raises SystemExit with the problems of a
    campaign that can not be read.
    """
    campaign, checks = check_file(given.campaign)
    if campaign is None:
        sys.exit(checks_text(checks))
    print(checks_text(checks))
    write_table(checks, made.checks, COLUMNS)
    write_text(checks_text(checks), made.text)
    save_plots([quicklook(campaign)], Path(made.figure[0]).parent)
