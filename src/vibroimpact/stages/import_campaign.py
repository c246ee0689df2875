"""Make a campaign of a folder of measurements, check it and draw it."""

import sys
from pathlib import Path
from typing import Any

from vibroimpact.campaign.checks.file_checks import check_campaign
from vibroimpact.campaign.checks.stated import COLUMNS
from vibroimpact.campaign.file import write_campaign
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.campaign.importing.report import import_text
from vibroimpact.io.records import write_table, write_text
from vibroimpact.io.signal_files.signals import ImportProblem
from vibroimpact.reports.figures.drawing import save_plots
from vibroimpact.reports.figures.quicklook import quicklook


def make(given: Any, made: Any, params: Any) -> None:
    """made: campaign, table, text, checks, figure. params: folder. Raises SystemExit with the
    problems of the folder.
    """
    try:
        campaign, rows = import_folder(params.folder)
    except ImportProblem as problem:
        sys.exit(str(problem))
    write_campaign(campaign, made.campaign)
    checks = check_campaign(campaign)
    write_table(rows, made.table)
    write_table(checks, made.checks, COLUMNS)
    write_text(import_text(params.folder, campaign, rows, checks), made.text)
    save_plots([quicklook(campaign)], Path(made.figure[0]).parent)
