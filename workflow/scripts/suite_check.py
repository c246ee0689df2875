"""Compare the quick verdicts of the sealed campaigns with the expected ones; fail where wrong."""

from vibroimpact.acceptance.quick_check import table
from vibroimpact.job_log import redirect_output
from vibroimpact.records import write_table
from vibroimpact.verdict.file import read_verdict

redirect_output(snakemake.log[0])
rows = table(
    {
        name: read_verdict(file)
        for name, file in zip(snakemake.params.checks, snakemake.input.verdicts, strict=True)
    }
)
for row in rows:
    print(row["check"], "right" if row["right"] else f"WRONG: {row['faults']}", flush=True)
wrong = [row for row in rows if not row["right"]]
if wrong:
    raise SystemExit(
        f"{len(wrong)} of {len(rows)} quick verdicts are wrong: "
        + "; ".join(f"{row['check']}: {row['faults']}" for row in wrong)
    )
write_table(rows, snakemake.output.table)
