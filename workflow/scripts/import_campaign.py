"""Make a campaign of a folder of measurements, check it and draw it."""

import sys
from pathlib import Path

from vibroimpact.campaign.file import write_campaign
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.campaign.importing.report import write_report
from vibroimpact.figures.discrepancy.quicklook import quicklook
from vibroimpact.figures.drawing import save_plots
from vibroimpact.io.job_log import redirect_output
from vibroimpact.io.signal_files.signals import ImportProblem

redirect_output(snakemake.log[0])
try:
    campaign, rows = import_folder(snakemake.params.folder)
except ImportProblem as problem:
    sys.exit(str(problem))
write_campaign(campaign, snakemake.output.campaign)
write_report(snakemake.params.folder, campaign, rows, snakemake.output)
save_plots(quicklook(campaign), Path(snakemake.output.figure[0]).parent)
