"""Make a campaign of a folder of measurements, check it and draw it."""

import sys
from pathlib import Path

from vibroimpact.campaign import write_campaign
from vibroimpact.figures.quicklook import quicklook
from vibroimpact.importing.assemble import import_folder
from vibroimpact.importing.report import write_report
from vibroimpact.importing.signals import ImportProblem

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
try:
    campaign, rows = import_folder(snakemake.params.folder)
except ImportProblem as problem:
    sys.exit(str(problem))
write_campaign(campaign, snakemake.output.campaign)
write_report(snakemake.params.folder, campaign, rows, snakemake.output)
quicklook(campaign)[0].save(Path(snakemake.output.figure[0]).parent)
