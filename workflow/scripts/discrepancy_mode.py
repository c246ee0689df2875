"""Write down whether a discrepancy run is a quick or a full one."""

import sys

from vibroimpact.records import write_text

sys.stderr = sys.stdout = open(snakemake.log[0], "w", buffering=1, encoding="utf-8")
write_text(f"{snakemake.params.mode}\n", snakemake.output.mode)
