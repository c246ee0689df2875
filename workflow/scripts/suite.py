"""Hold the suite's verdicts against their truths."""

import sys
from pathlib import Path

from vibroimpact.discrepancy.suite import confusion, rates, read
from vibroimpact.records import write_table

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
rows = read(Path(snakemake.output.rates).parent)
write_table(rows, snakemake.output.campaigns)
write_table(rates(rows), snakemake.output.rates)
write_table(confusion(rows), snakemake.output.confusion)
print(f"{len(rows)} campaigns judged")
